#include "core/phantom/spine_ground_truth.h"

#include <cmath>

#include "core/base/error.h"

namespace spinaltap {
namespace {

/// Where a ray from inside a body first leaves it.
Vec3 surface_along(const Spine& spine, std::size_t part, const Vec3& start, const Vec3& direction) {
  constexpr double kFarthest = 60.0, kStep = 0.1;
  double inside = 0.0;
  while (spine.part_value_mm(part, start + (inside + kStep) * direction) < 0.0) {
    inside += kStep;
    if (inside > kFarthest) fail("spine phantom: a process does not end within ", kFarthest, " mm");
  }
  double outside = inside + kStep;
  for (int halving = 0; halving < 50; ++halving) {
    const double middle = 0.5 * (inside + outside);
    (spine.part_value_mm(part, start + middle * direction) < 0.0 ? inside : outside) = middle;
  }
  return start + inside * direction;
}

Vec3 turned_normal(const PlacedLevel& level, double side) {
  const Vec3 own(side * std::tan(0.5 * level.side_wedge_deg * kDegree),
                 -side * std::tan(0.5 * level.measures.wedge_deg * kDegree), 1.0);
  return level.rotation * own.normalized();
}

LevelGroundTruth level_ground_truth(const Spine& spine, std::size_t n) {
  const PlacedLevel& placed = spine.placed()[n];
  const Vertebra& vertebra = *spine.part(n).vertebra;
  const VertebraAnatomy& anatomy = vertebra.anatomy();
  LevelGroundTruth ground_truth;
  ground_truth.level = placed.level;
  ground_truth.pedicles = vertebra_ground_truth(vertebra);
  ground_truth.body_centre_mm = placed.position_mm;
  const Vec3 half = 0.5 * anatomy.body.height_mm * placed.rotation.col(2);
  ground_truth.superior_endplate_mm = placed.position_mm + half;
  ground_truth.inferior_endplate_mm = placed.position_mm - half;
  ground_truth.superior_normal = turned_normal(placed, 1.0);
  ground_truth.inferior_normal = turned_normal(placed, -1.0);
  const auto& outline = anatomy.spinous.outline_mm;
  const Eigen::Vector2d end = 0.5 * (outline[1] + outline[3]);
  const Eigen::Vector2d along = (outline[2] - end).normalized();
  // From somewhat before the end, as corners are rounded.
  const Eigen::Vector2d before = end - 2.0 * along;
  ground_truth.spinous_tip_mm = surface_along(spine, n, vertebra.to_patient(Vec3(0.0, before.x(), before.y())),
                                              placed.rotation * Vec3(0.0, along.x(), along.y()));
  const Vec3 tip = anatomy.transverse.tip_mm;
  const Vec3 direction = (tip - anatomy.transverse.root_mm).normalized();
  const Vec3 mirror(-1.0, 1.0, 1.0);
  ground_truth.left_transverse_tip_mm = surface_along(spine, n, vertebra.to_patient(tip), placed.rotation * direction);
  ground_truth.right_transverse_tip_mm = surface_along(spine, n, vertebra.to_patient(tip.cwiseProduct(mirror)),
                                                       placed.rotation * direction.cwiseProduct(mirror));
  return ground_truth;
}

}  // namespace

SpineGroundTruth spine_ground_truth(const Spine& spine) {
  SpineGroundTruth ground_truth;
  const std::vector<PlacedLevel>& placed = spine.placed();
  for (std::size_t n = 0; n < placed.size(); ++n) {
    if (spine.part(n).vertebra) ground_truth.levels.push_back(level_ground_truth(spine, n));
    if (n == 0 || placed[n - 1].level == Level::kC1) continue;  // around the dens there is no disc
    const PlacedLevel& upper = placed[n - 1];
    const PlacedLevel& lower = placed[n];
    const Vec3 top = upper.position_mm - 0.5 * upper.measures.body_height_mm * upper.rotation.col(2);
    const Vec3 bottom = lower.position_mm + 0.5 * lower.measures.body_height_mm * lower.rotation.col(2);
    ground_truth.discs.push_back({.above = upper.level,
                                  .centre_mm = 0.5 * (top + bottom),
                                  .normal = (turned_normal(upper, -1.0) + turned_normal(lower, 1.0)).normalized(),
                                  .height_mm = disc_height_mm(upper, lower),
                                  .width_mm = 0.5 * (upper.measures.body_width_mm + lower.measures.body_width_mm),
                                  .depth_mm = 0.5 * (upper.measures.body_depth_mm + lower.measures.body_depth_mm)});
  }
  return ground_truth;
}

}  // namespace spinaltap
