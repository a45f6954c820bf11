#pragma once

#include <optional>
#include <vector>

#include "apps/spinaltap-planner/plan_document.h"
#include "apps/spinaltap-planner/scene/scene_camera.h"
#include "core/base/geometry.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// Where a ray (patient LPS, mm; unit direction) from outside first meets the bone's surface; nothing where it misses.
std::optional<Vec3> first_surface_mm(const BoneModel& bone, const Vec3& start_mm, const Vec3& direction);

/// An end of a path that can be taken hold of.
struct PathHandle {
  int path = 0;
  PathEnd end = PathEnd::entry;

  bool operator==(const PathHandle&) const = default;
};

inline constexpr double kHandlePixels = 7.0;  ///< radius of a handle, whatever the distance

Vec3 place_of(const DrillPath& path, PathEnd end);

/// The handle under a pixel: the nearest, where two are as near that of the chosen path.
std::optional<PathHandle> handle_at(const std::vector<DrillPath>& paths, int chosen, const SceneCamera& camera,
                                    const Eigen::Vector2d& pixel);

/// The path whose bit is under a pixel, also inside the bone; -1: none.
int path_at(const std::vector<DrillPath>& paths, const SceneCamera& camera, const Eigen::Vector2d& pixel);

}  // namespace spinaltap
