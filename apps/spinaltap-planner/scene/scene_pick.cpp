#include "apps/spinaltap-planner/scene/scene_pick.h"
#include "core/tool/path_curve.h"

#include <algorithm>
#include <array>
#include <limits>

namespace spinaltap {
namespace {

/// The stretch of a ray within a box; empty where begin is beyond end.
struct RayStretch {
  double begin_mm = 0.0;
  double end_mm = std::numeric_limits<double>::infinity();
};

RayStretch ray_within(const Box3& box, const Vec3& start_mm, const Vec3& direction) {
  RayStretch stretch;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.min()[axis] - start_mm[axis]) / direction[axis];
    const double b = (box.max()[axis] - start_mm[axis]) / direction[axis];
    // Along an axis that the ray does not go, the quotients are infinite, or not a number on the box's side itself.
    stretch.begin_mm = std::max(stretch.begin_mm, std::min(a, b));
    stretch.end_mm = std::min(stretch.end_mm, std::max(a, b));
  }
  return stretch;
}

/// How far a pixel lies from a stretch between two others.
double pixels_to_stretch(const Eigen::Vector2d& pixel, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double square = along.squaredNorm();
  const double share = square > 0.0 ? std::clamp((pixel - a).dot(along) / square, 0.0, 1.0) : 0.0;
  return (pixel - a - share * along).norm();
}

}  // namespace

std::optional<Vec3> first_surface_mm(const BoneModel& bone, const Vec3& start_mm, const Vec3& direction) {
  constexpr double kNearMm = 1e-3;
  constexpr double kShare = 0.9;  // interpolated distances grow a little faster than 1 mm a mm here and there
  constexpr int kMaxSteps = 2000;
  const double margin_mm = bone.band_mm();
  const Box3 bounds_mm = bone.bounds_mm();
  const Box3 box(bounds_mm.min() - Vec3::Constant(margin_mm), bounds_mm.max() + Vec3::Constant(margin_mm));
  const RayStretch stretch = ray_within(box, start_mm, direction);
  // Sphere tracing (Hart 1996): no step is longer than the way to the nearest surface.
  double way_mm = stretch.begin_mm;
  for (int step = 0; step < kMaxSteps && way_mm <= stretch.end_mm; ++step) {
    const Vec3 p_mm = start_mm + way_mm * direction;
    std::array<float, 1> free_mm{};
    bone.distance({&p_mm, 1}, free_mm, {});
    if (static_cast<double>(free_mm[0]) < kNearMm) return p_mm;
    way_mm += std::max(kNearMm, kShare * static_cast<double>(free_mm[0]));
  }
  return std::nullopt;
}

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
    double off = std::numeric_limits<double>::infinity();
    std::vector<Vec3> places_mm{base_mm, path.target_mm};
    if (path.is_curved()) places_mm = PathCurve(path).places_mm(1.0);
    for (std::size_t k = 1; k < places_mm.size(); ++k) {
      off = std::min(off, pixels_to_stretch(pixel, camera.to_pixel(places_mm[k - 1]), camera.to_pixel(places_mm[k])));
    }
    if (off > reach || depth >= nearest_depth) continue;
    nearest = n;
    nearest_depth = depth;
  }
  return nearest;
}

}  // namespace spinaltap
