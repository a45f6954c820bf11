#include "apps/spinaltap-planner/scene/scene_pick.h"

#include <algorithm>
#include <limits>

namespace spinaltap {
namespace {

/// How far a pixel lies from a stretch between two others.
double pixels_to_stretch(const Eigen::Vector2d& pixel, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double square = along.squaredNorm();
  const double share = square > 0.0 ? std::clamp((pixel - a).dot(along) / square, 0.0, 1.0) : 0.0;
  return (pixel - a - share * along).norm();
}

}  // namespace

Vec3 place_of(const DrillPath& path, PathEnd end) { return end == PathEnd::entry ? path.entry_mm : path.target_mm; }

std::optional<PathHandle> handle_at(const std::vector<DrillPath>& paths, int chosen, const SceneCamera& camera,
                                    const Eigen::Vector2d& pixel) {
  constexpr double kReachPixels = kHandlePixels + 5.0;
  constexpr double kChosenIsNearer = 3.0;
  std::optional<PathHandle> nearest;
  double nearest_pixels = kReachPixels;
  for (int n = 0; n < static_cast<int>(paths.size()); ++n) {
    for (const PathEnd end : {PathEnd::entry, PathEnd::target}) {
      const Vec3 place = place_of(paths[static_cast<std::size_t>(n)], end);
      if (!(camera.depth_mm(place) > 0.0)) continue;
      const double pixels = (camera.to_pixel(place) - pixel).norm();
      if (pixels > kReachPixels) continue;
      const double ranked = n == chosen ? pixels - kChosenIsNearer : pixels;
      if (nearest && ranked >= nearest_pixels) continue;
      nearest = PathHandle{n, end};
      nearest_pixels = ranked;
    }
  }
  return nearest;
}

int path_at(const std::vector<DrillPath>& paths, const SceneCamera& camera, const Eigen::Vector2d& pixel) {
  constexpr double kSlackPixels = 4.0;
  int nearest = -1;
  double nearest_depth = std::numeric_limits<double>::infinity();
  for (int n = 0; n < static_cast<int>(paths.size()); ++n) {
    const DrillPath& path = paths[static_cast<std::size_t>(n)];
    const Vec3 base_mm = path.target_mm - std::max(path.bit.length_mm, path.length_mm()) * path.direction();
    const double depth = camera.depth_mm(0.5 * (path.target_mm + base_mm));
    if (!(camera.depth_mm(base_mm) > 0.0 && camera.depth_mm(path.target_mm) > 0.0)) continue;
    const double reach = kSlackPixels + path.bit.radius_mm() / camera.mm_per_pixel(depth);
    const double off = pixels_to_stretch(pixel, camera.to_pixel(base_mm), camera.to_pixel(path.target_mm));
    if (off > reach || depth >= nearest_depth) continue;
    nearest = n;
    nearest_depth = depth;
  }
  return nearest;
}

}  // namespace spinaltap
