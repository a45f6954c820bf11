#include "apps/spinaltap/bench/drill_workload.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/engine/drill_engine.h"

namespace spinaltap {
namespace {

/// Of the bit's line from the path's, at the tip.
double off_path_mm(const Pose& pose) {
  const DrillPath path = workload_path(3.0);
  return (pose.tip_mm - path.entry_mm).cross(path.direction()).norm();
}

TEST(DrillWorkload, HasThePapersPoints) {
  const PointVolume volume = workload_volume(0.1);
  EXPECT_EQ(volume.disc_count(), 378);
  EXPECT_EQ(volume.pattern().point_count(), 2'611U);
  EXPECT_EQ(volume.point_count(), 986'958U);
  EXPECT_EQ(volume.occupied_count(), 986'958U);
  EXPECT_EQ(workload_volume(0.05).point_count(), 8'029'476U);
  const PointVolume finest(workload_path(3.0), {.radius_mm = 3.0, .spacing_mm = 0.025, .hu_bits = HuBits::eight});
  EXPECT_EQ(finest.point_count(), 64'775'592U);
}

TEST(DrillWorkload, VariesItsCtNumbersAlongThePath) {
  const PointVolume volume = workload_volume(0.1, HuBits::sixteen);
  EXPECT_EQ(volume.hu(0, 0), 300);
  EXPECT_EQ(volume.hu(12, 2'610), 400);                 // round(100 sin(2 pi 1.2/5)) = 100
  EXPECT_EQ(volume.hu(37, 5), 200);                     // 100 sin(2 pi 3.7/5) = -99.8
  EXPECT_NEAR(workload_volume(0.1).hu(12, 0), 400, 8);  // steps of 16 HU
}

TEST(DrillWorkload, IsOccupiedAgainAfterItIsRestored) {
  PointVolume volume = workload_volume(0.2);
  const std::vector<std::uint64_t> before(volume.occupancy_words().begin(), volume.occupancy_words().end());
  const auto engine = make_ring_engine(volume, workload_path(3.0).bit, Material());
  engine->step(workload_poses(WorkloadMotion::on_path).back());
  EXPECT_LT(volume.occupied_count(), volume.point_count());
  restore_all(volume);
  EXPECT_EQ(volume.occupied_count(), volume.point_count());
  EXPECT_TRUE(
      std::equal(before.begin(), before.end(), volume.occupancy_words().begin(), volume.occupancy_words().end()));
}

TEST(DrillWorkload, MovesAsItsNamesSay) {
  const DrillPath path = workload_path(3.06);
  EXPECT_NEAR(path.length_mm(), 37.8, 1e-9);
  EXPECT_EQ(path.bit.diameter_mm, 3.06);
  for (const WorkloadMotion motion : workload_motions()) {
    const std::vector<Pose> poses = workload_poses(motion);
    ASSERT_EQ(poses.size(), 37'801U) << name_of(motion);
    const std::string name(name_of(motion));
    const bool is_off = name.ends_with("off-path");
    const double tremor_mm = name.starts_with("tremor") ? 0.4 : 1e-9;
    EXPECT_NEAR(off_path_mm(poses[18'900]), is_off ? 1.2 : 0.0, tremor_mm) << name_of(motion);
    const double degrees = std::acos(std::min(1.0, poses[100].axis.dot(path.direction()))) * 180.0 / std::numbers::pi;
    const double expected = name == "tilted" ? 3.0 : name.starts_with("tilted-") ? std::stod(name.substr(7)) : 0.0;
    EXPECT_NEAR(degrees, expected, 1e-5) << name;
    EXPECT_EQ(workload_way(motion).max_tilt_deg, expected) << name;
    EXPECT_EQ(workload_way(motion).trembles, name.starts_with("tremor")) << name;
    const bool is_burr = name.find("burr") != std::string::npos;
    EXPECT_EQ(workload_bit(motion, 2.5).shape, is_burr ? BitShape::round_burr : BitShape::drill) << name;
    EXPECT_EQ(workload_bit(motion, 2.5).diameter_mm, 2.5) << name;
  }
  EXPECT_EQ(std::ranges::count_if(workload_motions(), is_of_paper), 5);
}

TEST(DrillWorkload, StepsSidewaysWithinTheCylinder) {
  for (const auto& [step, way_mm] : {std::pair(burr_step(), 1.0), std::pair(sideways_step(), 2.4)}) {
    EXPECT_NEAR((step.to.tip_mm - step.from.tip_mm).norm(), way_mm, 1e-9) << step.name;
    EXPECT_NEAR((step.to.tip_mm - step.from.tip_mm).dot(step.from.axis), 0.0, 1e-9);
    PointVolume volume = workload_volume(0.1);
    const auto engine = make_ring_engine(volume, step.bit, Material());
    engine->step(step.from);
    // The spacing is 1/4 of that of the benchmark, so 1/64 of the points: still plenty.
    EXPECT_GT(engine->step(step.to).removed, 50'000U) << step.name;
  }
}

}  // namespace
}  // namespace spinaltap
