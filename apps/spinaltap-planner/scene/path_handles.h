#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apps/spinaltap-planner/scene/scene_camera.h"
#include "apps/spinaltap-planner/scene/scene_pick.h"
#include "apps/spinaltap-planner/scene/vtk_names.h"

namespace spinaltap {

/// The ends of paths as things to take hold of: a ball at the entry, an octahedron at the target, always of one size on
/// the screen.
class PathHandles {
 public:
  /// `front` is drawn over everything else, so that handles show inside the bone.
  explicit PathHandles(vtkRenderer& front);
  ~PathHandles();
  PathHandles(const PathHandles&) = delete;
  PathHandles& operator=(const PathHandles&) = delete;

  /// `hot`: under the pointer, or held.
  void prepare(const std::vector<DrillPath>& paths, int chosen, const std::optional<PathHandle>& hot,
               const SceneCamera& camera);

 private:
  struct Shape;

  vtkRenderer& front_;
  std::vector<std::unique_ptr<Shape>> shapes_;  ///< two a path: entry, target
};

}  // namespace spinaltap
