#include "core/segment/vertebral_body.h"

#include <algorithm>
#include <cmath>

namespace spinaltap {
namespace {

constexpr int kDirections = 2000;
constexpr double kStepMm = 0.5;
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

}  // namespace

VertebralBody find_vertebral_body(const FloatGrid& hu, const Vec3& seed_mm, const WallLevels& levels) {
  BodyCylinder cylinder = fit_body_cylinder(hu, seed_mm, levels);
  const double facing_rad = facing_of_arch_rad(hu, cylinder, levels.bone_hu);
  if (facing_rad != 0.0) {
    const BodyCylinder turned = fit_body_cylinder(hu, seed_mm, levels, facing_rad);
    // A body that fits as well as before: otherwise there was no arch, only other bone at the side.
    if (turned.fit > 0.9 * cylinder.fit) cylinder = turned;
  }
  StarSurface surface(cylinder.centre_mm, kDirections);
  std::vector<Exit> exits;
  for (const Vec3& direction : surface.directions()) exits.push_back(leave(cylinder, direction));
  constexpr int kHalfSteps = static_cast<int>(kReachMm / kStepMm);
  const auto radius_mm = [&](int direction, int step) {
    return std::max(exits[static_cast<std::size_t>(direction)].radius_mm + (step - kHalfSteps) * kStepMm, kStepMm);
  };
  StarCost cost;
  cost.step_count = 2 * kHalfSteps + 1;
  cost.stiffness = kStiffnessPerMm * kStepMm;
  cost.most_difference = kHalfSteps;
  cost.cost = [&](int direction, int step) {
    const auto at = static_cast<std::size_t>(direction);
    const Vec3 p_mm = cylinder.centre_mm + radius_mm(direction, step) * surface.directions()[at];
    // Without a wall the cylinder's own place is as good as any.
    constexpr double kAwayFromCylinder = 0.2;
    const double away = static_cast<double>(step - kHalfSteps) / kHalfSteps;
    return kAwayFromCylinder * away * away - wall_edge(hu, p_mm, exits[at].outward, levels);
  };
  const std::vector<int> steps = choose_steps(surface, cost);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    surface.radii_mm()[i] = radius_mm(static_cast<int>(i), steps[i]);
  }
  return {cylinder, surface};
}

}  // namespace spinaltap
