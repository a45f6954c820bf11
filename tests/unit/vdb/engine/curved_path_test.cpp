#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/session/operator/path_motion.h"
#include "core/tool/path_curve.h"
#include "tests/support/made_bone.h"
#include "tests/support/random_drilling.h"
#include "vdb/engine/make_engine.h"
#include "vdb/engine/voxel_bone.h"
#include "vdb/engine/voxel_engine.h"

namespace spinaltap {
namespace {

using test::expect_same_removal;

/// A curve that leaves its plane, within a solid block; a ball of 3 mm follows it.
DrillPath winding() {
  DrillPath path{"winding", {31.0, 226.0, -618.0}, {29.0, 200.0, -615.0}, steerable_head()};
  path.via_mm = {{32.0, 218.0, -616.8}, {31.3, 208.0, -616.8}};
  return path;
}

BoneModel solid_block() {
  const Vec3 middle_mm(31.5, 213.0, -617.0), half_mm(8.0, 18.0, 8.0);
  const auto distance_mm = [&](const Vec3& p) {
    const Vec3 beyond = (p - middle_mm).cwiseAbs() - half_mm;
    return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
  };
  const Vec3 room_mm = half_mm + Vec3::Constant(2.0);
  return test::made_bone(distance_mm, {middle_mm - room_mm, middle_mm + room_mm}, 0.5);
}

/// What a ball leaves on the way of its centre, 1.5 mm behind the tip: by Pappus' theorem its section times that way's
/// length, and half a ball at each end.
double hole_mm3(const DrillPath& path, double step_mm) {
  const PathCurve curve(path);
  const double radius_mm = path.bit.radius_mm();
  double way_mm = 0.0;
  const int steps = static_cast<int>(std::ceil(curve.length_mm() / step_mm));
  const auto centre_mm = [&](int n) {
    const Pose pose = curve.pose_at(curve.length_mm() * n / steps);
    return Vec3(pose.tip_mm - radius_mm * pose.axis);
  };
  for (int n = 0; n < steps; ++n) way_mm += (centre_mm(n + 1) - centre_mm(n)).norm();
  const double section_mm2 = std::numbers::pi * radius_mm * radius_mm;
  return section_mm2 * way_mm + 4.0 / 3.0 * section_mm2 * radius_mm;
}

double removed_along(const DrillPath& path, DrillEngine& engine) {
  const PathMotion motion(path, in_steps_of(0.05));
  double removed_mm3 = 0.0;
  for (std::size_t n = 0; n <= motion.cycle_count(); ++n) removed_mm3 += engine.step(motion.pose(n)).removed_mm3;
  return removed_mm3;
}

TEST(CurvedHole, HasTheVolumeOfItsSectionAlongTheWay) {
  const DrillPath path = winding();
  const BoneModel block = solid_block();
  VoxelBone bone(block, {.voxel_mm = 0.1});
  const auto engine = make_voxel_engine(bone, path.bit, Material());
  const double removed_mm3 = removed_along(path, *engine);
  const double expected_mm3 = hole_mm3(path, 0.01);
  EXPECT_NEAR(removed_mm3, expected_mm3, 0.002 * expected_mm3);
  RecordProperty("share", std::to_string(removed_mm3 / expected_mm3));
}

TEST(CurvedHole, IsTheSameForAllEnginesOfPoints) {
  const DrillPath path = winding();
  const PointVolumeOptions options{.radius_mm = 2.0, .spacing_mm = 0.2, .lead_in_mm = 2.0};
  const PathMotion motion(path, {.line = {.lead_in_mm = 2.0}, .rate_hz = 20.0, .tremor_mm = 0.05, .seed = 3});
  std::vector<PointVolume> volumes(4, PointVolume(path, options));
  std::vector<std::unique_ptr<DrillEngine>> engines;
  const EngineKind kinds[]{EngineKind::reference, EngineKind::ring, EngineKind::leaf, EngineKind::arc};
  for (std::size_t k = 0; k < volumes.size(); ++k) {
    engines.push_back(make_engine(kinds[k], volumes[k], path.bit, Material()));
  }
  double removed_mm3 = 0.0;
  for (std::size_t n = 0; n <= motion.cycle_count(); ++n) {
    const StepResult first = engines[0]->step(motion.pose(n));
    removed_mm3 += first.removed_mm3;
    for (std::size_t k = 1; k < engines.size(); ++k) expect_same_removal(engines[k]->step(motion.pose(n)), first);
    ASSERT_FALSE(HasFailure()) << n;
  }
  for (std::size_t k = 1; k < volumes.size(); ++k) {
    EXPECT_TRUE(std::equal(volumes[k].occupancy_words().begin(), volumes[k].occupancy_words().end(),
                           volumes[0].occupancy_words().begin()));
  }
  // From the cylinder's begin, where the ball stands behind it, and with a tremor: the lattice is good for 1 %.
  const PathCurve curve(path);
  const double section_mm2 = std::numbers::pi * path.bit.radius_mm() * path.bit.radius_mm();
  EXPECT_GT(removed_mm3, section_mm2 * curve.length_mm());
}

TEST(CurvedHole, OfPointsHasItsVolumeWithinTheLatticesError) {
  const DrillPath path = winding();
  // The whole ball is in the cylinder from the first pose on.
  PointVolume volume(path, {.radius_mm = 2.0, .spacing_mm = 0.1, .lead_in_mm = 6.0});
  const auto engine = make_engine(EngineKind::leaf, volume, path.bit, Material());
  const double removed_mm3 = removed_along(path, *engine);
  const double expected_mm3 = hole_mm3(path, 0.01);
  EXPECT_NEAR(removed_mm3, expected_mm3, 0.005 * expected_mm3);
  RecordProperty("share", std::to_string(removed_mm3 / expected_mm3));
}

}  // namespace
}  // namespace spinaltap
