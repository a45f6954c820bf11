#include "apps/spinaltap/bench/milling_workload.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

const BoneModel& milled() {
  static const BoneModel bone = milling_bone();
  return bone;
}

SLOW_TESTS("MillingWorkload.BeginsOnTheEndplate", "MillingWorkload.TakesTheSameVolumeOfPointsAndVoxels");

TEST(MillingWorkload, GoesItsWayInStepsAndTrembles) {
  for (const double step_mm : {0.05, 0.01}) {
    const std::vector<Pose> poses = milling_poses({.tilt_deg = 30.0, .step_mm = step_mm}, 10'000);
    ASSERT_EQ(poses.size(), 10'001U);
    double way_mm = 0.0;
    for (std::size_t n = 1; n < poses.size(); ++n) {
      way_mm += (poses[n].tip_mm - poses[n - 1].tip_mm).norm();
      ASSERT_NEAR(poses[n].axis.dot(-Vec3::UnitZ()), std::cos(30.0 * kDegree), 1e-12);
    }
    // A tremor of 0.1 mm at 10 Hz goes at some 6 mm/s beside the hand's 50.
    EXPECT_GT(way_mm, 10'000 * step_mm);
    EXPECT_LT(way_mm, 1.1 * 10'000 * step_mm);
  }
}

TEST(MillingWorkload, StaysWithinItsSquareAndGoesDownALayerAfterFourteenLines) {
  // A layer: 14 lines of 14 mm and what lies between, 210 mm, 4,200 steps.
  const std::vector<Pose> poses = milling_poses({}, 3 * 4'200);
  const Vec3 start_mm = milling_start_mm();
  constexpr double kTremorMm = 0.5;
  for (std::size_t n = 0; n < poses.size(); ++n) {
    const Vec3 at_mm = poses[n].tip_mm - start_mm;
    ASSERT_LE(std::abs(at_mm.x()), 7.0 + kTremorMm) << n;
    ASSERT_LE(std::abs(at_mm.y()), 7.0 + kTremorMm) << n;
    const double layer = std::floor(static_cast<double>(n) / 4'200.0);
    ASSERT_NEAR(at_mm.z(), -1.0 - layer, 1.0 + kTremorMm) << n;
  }
  EXPECT_NEAR((poses.back().tip_mm - start_mm).z(), -4.0, kTremorMm);
}

TEST(MillingWorkload, BeginsOnTheEndplate) {
  const BoneModel& bone = milled();
  const Vec3 start_mm = milling_start_mm();
  const std::vector<Vec3> around{start_mm - Vec3(0.0, 0.0, 0.3), start_mm + Vec3(0.0, 0.0, 0.3)};
  std::uint8_t inside[2];
  bone.inside(around, inside);
  EXPECT_EQ(inside[0], 1);
  EXPECT_EQ(inside[1], 0);
}

TEST(MillingWorkload, TakesTheSameVolumeOfPointsAndVoxels) {
  const BoneModel& bone = milled();
  for (const double tilt_deg : {0.0, kMaxPointTiltDeg}) {
    const MillingWorkload workload{.diameter_mm = 6.0, .tilt_deg = tilt_deg, .spacing_mm = 0.25};
    const std::vector<Pose> poses = milling_poses(workload, kMillingCycles);
    double mm3[2];
    for (const EngineKind kind : {EngineKind::leaf, EngineKind::voxel}) {
      const DrilledBone whole = milled_bone(bone, kind, workload.spacing_mm);
      DrilledBone left(whole);
      const WayRun run = milling_run(left, whole, workload, poses);
      const std::unique_ptr<DrillEngine> engine = run.begin();
      double& sum_mm3 = mm3[kind == EngineKind::voxel];
      sum_mm3 = 0.0;
      for (std::size_t n = 0; n < poses.size(); n += 5) sum_mm3 += engine->step(poses[n]).removed_mm3;
      EXPECT_LT(run.occupancy_hash(), whole.occupied_count());
      run.begin();
      EXPECT_EQ(run.occupancy_hash(), whole.occupied_count()) << "all bone lives again";
    }
    // At least what the balls' middle plane sweeps, 14 mm wide and some 6 mm deep.
    EXPECT_GT(mm3[0], 14.0 * 14.0 * 6.0);
    EXPECT_NEAR(mm3[1], mm3[0], 0.01 * mm3[0]) << tilt_deg;
  }
}

}  // namespace
}  // namespace spinaltap
