#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "apps/spinaltap-planner/scene/scene_camera.h"
#include "apps/spinaltap-planner/scene/vtk_names.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

class ToolActor;

/// The paths in 3D: each one's bit at the target, its screw, its axis and its name. The chosen one strong, the others
/// faint.
class PathActors {
 public:
  /// `front` is drawn over `scene`, so that axes and names show inside the bone too.
  PathActors(vtkRenderer& scene, vtkRenderer& front);
  ~PathActors();
  PathActors(const PathActors&) = delete;
  PathActors& operator=(const PathActors&) = delete;

  /// `bit` is drawn in place of the chosen path's own bit and screw; with `shows_tools` false none of any path is.
  void set_paths(const std::vector<DrillPath>& paths, int chosen, const std::optional<std::pair<DrillBit, Pose>>& bit,
                 bool shows_tools);
  /// Puts names where they now belong.
  void prepare(const SceneCamera& camera, double height_px, double pixel_ratio);

 private:
  struct PathShape;

  vtkRenderer& scene_;
  vtkRenderer& front_;
  std::vector<std::unique_ptr<PathShape>> shapes_;
  std::unique_ptr<ToolActor> drilling_;
};

}  // namespace spinaltap
