#include "apps/spinaltap-planner/scene/surface_ray.h"

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

}  // namespace

std::optional<Vec3> first_surface_mm(const BoneModel& bone, const Vec3& start_mm, const Vec3& direction) {
  constexpr double kNearMm = 1e-3;
  constexpr double kShare = 0.9;  // interpolated distances grow a little faster than 1 mm a mm here and there
  constexpr int kMostSteps = 2000;
  const double margin_mm = bone.band_mm();
  const Box3 bounds_mm = bone.bounds_mm();
  const Box3 box(bounds_mm.min() - Vec3::Constant(margin_mm), bounds_mm.max() + Vec3::Constant(margin_mm));
  const RayStretch stretch = ray_within(box, start_mm, direction);
  // Sphere tracing (Hart 1996): no step is longer than the way to the nearest surface.
  double way_mm = stretch.begin_mm;
  for (int step = 0; step < kMostSteps && way_mm <= stretch.end_mm; ++step) {
    const Vec3 p_mm = start_mm + way_mm * direction;
    std::array<float, 1> free_mm{};
    bone.distance({&p_mm, 1}, free_mm, {});
    if (static_cast<double>(free_mm[0]) < kNearMm) return p_mm;
    way_mm += std::max(kNearMm, kShare * static_cast<double>(free_mm[0]));
  }
  return std::nullopt;
}

}  // namespace spinaltap
