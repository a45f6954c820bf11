#include "core/segment/vertebral_body.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace spinaltap {
namespace {

constexpr int kSurfaceDirections = 2000;
constexpr double kSearchStepMm = 0.5;
constexpr double kReachMm = 6.0;  // how far the surface may lie from the cylinder
constexpr double kStiffnessPerMm = 0.08;

/// Where a ray from the cylinder's middle leaves it: the way there (mm) and the outward normal.
struct Exit {
  double radius_mm;
  Vec3 outward;
};

Exit leave(const BodyCylinder& cylinder, const Vec3& direction) {
  const Mat3 axes = cylinder.axes();
  const Vec3 way = (axes.transpose() * direction).cwiseQuotient(cylinder.half_mm);
  const double across = std::hypot(way.x(), way.y());
  const double up = std::abs(way.z());
  const Vec3 normal = up > across ? Vec3(0.0, 0.0, way.z() > 0.0 ? 1.0 : -1.0) : Vec3(way.x(), way.y(), 0.0);
  return {1.0 / std::max(across, up), (axes * normal.cwiseQuotient(cylinder.half_mm)).normalized()};
}

/// The cylinder between a span's ends.
BodyCylinder cylinder_of(const BodySpan& span) {
  const Vec3 up = (span.lower.up + span.upper.up).normalized();
  const Vec3 left = span.middle.axes.col(0);
  Mat3 axes;
  axes.col(2) = up;
  axes.col(0) = (left - left.dot(up) * up).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  BodyCylinder cylinder;
  cylinder.set_axes(axes);
  cylinder.centre_mm = 0.5 * (span.lower.centre_mm + span.upper.centre_mm);
  cylinder.half_mm = Vec3(span.middle.half_width_mm, span.middle.half_depth_mm,
                          0.5 * (span.upper.centre_mm - span.lower.centre_mm).dot(up));
  return cylinder;
}

RefineLimits limits_of(const BodySpan& span) {
  RefineLimits limits;
  if (span.is_cut()) limits.end_shift_mm = 0.0;
  return limits;
}

/// Where the search for a body begins that lies on its span as another body does on its own, and is as large.
BodyCylinder start_like(const BodyCylinder& other, const BodySpan& other_span, const BodySpan& span) {
  const BodyCylinder other_start = cylinder_of(other_span);
  const Vec3 off = other_start.axes().transpose() * (other.centre_mm - other_start.centre_mm);
  BodyCylinder start = cylinder_of(span);
  start.centre_mm += start.axes() * Vec3(off.x(), off.y(), 0.0);
  start.half_mm.head<2>() = other.half_mm.head<2>();
  return start;
}

/// The search from the start itself. From further forward and back too, for where the column's course is off; but
/// there other walls are near, and only what fits clearly better counts.
BodyCylinder refine_from_several(const WallProbe& probe, const BodyCylinder& start, const RefineLimits& limits) {
  constexpr double kAsideMm = 4.0;
  constexpr double kClearlyBetter = 1.3;
  BodyCylinder best = refine_body_cylinder(probe, start, limits);
  for (const double backward_mm : {-kAsideMm, kAsideMm}) {
    BodyCylinder other = start;
    other.centre_mm += backward_mm * start.axes().col(1);
    other = refine_body_cylinder(probe, other, limits);
    if (other.fit > kClearlyBetter * best.fit) best = other;
  }
  return best;
}

}  // namespace

std::vector<BodyCylinder> find_body_cylinders(const WallProbe& probe, const std::vector<BodySpan>& chain) {
  std::vector<BodyCylinder> bodies(chain.size());
  tbb::parallel_for(std::size_t{0}, bodies.size(), [&](std::size_t n) {
    bodies[n] = refine_from_several(probe, cylinder_of(chain[n]), limits_of(chain[n]));
  });
  if (bodies.empty()) return bodies;
  const auto best = std::max_element(bodies.begin(), bodies.end(),
                                     [](const BodyCylinder& a, const BodyCylinder& b) { return a.fit < b.fit; });
  const auto try_like = [&](std::size_t n, std::size_t other) {
    const BodyCylinder start = start_like(bodies[other], chain[other], chain[n]);
    const BodyCylinder found = refine_from_several(probe, start, limits_of(chain[n]));
    if (found.fit > bodies[n].fit) bodies[n] = found;
  };
  const auto first = static_cast<std::size_t>(best - bodies.begin());
  for (std::size_t n = first + 1; n < bodies.size(); ++n) try_like(n, n - 1);
  for (std::size_t n = first; n-- > 0;) try_like(n, n + 1);
  return bodies;
}

VertebralBody find_vertebral_body(const WallProbe& probe, const BodyCylinder& cylinder) {
  StarSurface surface(cylinder.centre_mm, kSurfaceDirections);
  std::vector<Exit> exits;
  for (const Vec3& direction : surface.directions()) exits.push_back(leave(cylinder, direction));
  constexpr int kHalfSteps = static_cast<int>(kReachMm / kSearchStepMm);
  const auto radius_mm = [&](int direction, int step) {
    return std::max(exits[static_cast<std::size_t>(direction)].radius_mm + (step - kHalfSteps) * kSearchStepMm,
                    kSearchStepMm);
  };
  StarCost cost;
  cost.step_count = 2 * kHalfSteps + 1;
  cost.stiffness = kStiffnessPerMm * kSearchStepMm;
  cost.max_difference = kHalfSteps;
  cost.cost = [&](int direction, int step) {
    const auto at = static_cast<std::size_t>(direction);
    const Vec3 p_mm = cylinder.centre_mm + radius_mm(direction, step) * surface.directions()[at];
    // Without a wall the cylinder's own place is as good as any.
    constexpr double kAwayFromCylinder = 0.2;
    const double away = static_cast<double>(step - kHalfSteps) / kHalfSteps;
    return kAwayFromCylinder * away * away - probe.edge(p_mm, exits[at].outward);
  };
  const std::vector<int> steps = choose_steps(surface, cost);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    surface.radii_mm()[i] = radius_mm(static_cast<int>(i), steps[i]);
  }
  return {cylinder, surface};
}

}  // namespace spinaltap
