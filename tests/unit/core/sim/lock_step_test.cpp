#include "core/sim/lock_step.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/base/error.h"

namespace spinaltap {
namespace {

DrillPath paper_path() {
  const Vec3 entry_mm(40.0, 120.0, -300.0);
  return {"paper", entry_mm, entry_mm + 37.8 * Vec3(-0.36, -0.8, 0.48), {}};
}

/// Distance from p to the path's line.
double off_line_mm(const DrillPath& path, const Vec3& p) { return (p - path.entry_mm).cross(path.direction()).norm(); }

/// Records the poses it is given.
class Recorder final : public DrillEngine {
 public:
  StepResult step(const Pose& pose) noexcept override {
    if (count < poses.size()) poses[count] = pose;
    ++count;
    return {.removed = count, .tested = 2 * count, .removed_hu = -1, .work_n_mm = 0.5, .thrust_n = 0.25};
  }
  std::size_t memory_bytes() const override { return sizeof(*this); }
  std::vector<Pose> poses = std::vector<Pose>(1000);
  std::size_t count = 0;
};

TEST(LockStepMotion, TakesAsManyCyclesAsTheWayHoldsSteps) {
  EXPECT_EQ(LockStepMotion(paper_path(), 0.0, {.step_mm = 0.001}).cycle_count(), 37'800U);
  EXPECT_EQ(LockStepMotion(paper_path(), 4.2, {.step_mm = 0.001}).cycle_count(), 42'000U);
  EXPECT_EQ(LockStepMotion(paper_path(), 0.0, {.step_mm = 1.0}).cycle_count(), 38U);
}

TEST(LockStepMotion, EndsAtTheTargetWithoutDrift) {
  const DrillPath path = paper_path();
  for (const double step_mm : {0.001, 0.0007, 0.05, 1.0, 50.0}) {
    const LockStepMotion motion(path, 3.0, {.step_mm = step_mm});
    EXPECT_LT((motion.pose(0).tip_mm - (path.entry_mm - 3.0 * path.direction())).norm(), 1e-9);
    EXPECT_LT((motion.pose(motion.cycle_count()).tip_mm - path.target_mm).norm(), 1e-9) << step_mm;
    EXPECT_NEAR(motion.depth_mm(motion.cycle_count()), 37.8, 1e-9);
    EXPECT_LT((motion.pose(1).axis - path.direction()).norm(), 1e-14);
  }
}

TEST(LockStepMotion, StaysOnItsLineAtEvenSteps) {
  const DrillPath path = paper_path();
  const LockStepMotion motion(path, 0.0, {.step_mm = 0.001});
  for (std::size_t i = 0; i < motion.cycle_count(); i += 997) {
    EXPECT_LT(off_line_mm(path, motion.pose(i).tip_mm), 1e-9);
    EXPECT_NEAR((motion.pose(i).tip_mm - path.entry_mm).norm(), 0.001 * static_cast<double>(i), 1e-9);
    EXPECT_NEAR((motion.pose(i + 1).tip_mm - motion.pose(i).tip_mm).norm(), 0.001, 1e-9);
  }
}

TEST(LockStepMotion, RunsBesideThePathByItsOffset) {
  const DrillPath path = paper_path();
  const LockStepMotion motion(path, 2.0, {.step_mm = 0.1, .offset_mm = 1.2});
  for (std::size_t i = 0; i <= motion.cycle_count(); ++i) {
    EXPECT_NEAR(off_line_mm(path, motion.pose(i).tip_mm), 1.2, 1e-9);
    EXPECT_NEAR((motion.pose(i).tip_mm - path.entry_mm).dot(path.direction()), motion.depth_mm(i), 1e-9);
  }
}

TEST(LockStepMotion, MeetsThePathInItsMiddleWhenTilted) {
  const DrillPath path = paper_path();
  const LockStepMotion motion(path, 5.0, {.step_mm = 0.1, .tilt_deg = 3.0});
  EXPECT_NEAR(std::acos(motion.pose(0).axis.dot(path.direction())), 3.0 * std::numbers::pi / 180.0, 1e-9);
  const Vec3 middle_mm = 0.5 * (path.entry_mm + path.target_mm);
  double nearest_mm = 1e9;
  for (std::size_t i = 0; i <= motion.cycle_count(); ++i) {
    nearest_mm = std::min(nearest_mm, (motion.pose(i).tip_mm - middle_mm).norm());
    // The tip leaves the path's line by the sine of the tilt.
    EXPECT_NEAR(off_line_mm(path, motion.pose(i).tip_mm),
                std::abs(motion.depth_mm(i) - 18.9) * std::sin(3.0 * std::numbers::pi / 180.0), 1e-9);
  }
  EXPECT_LT(nearest_mm, 1e-9);  // 18.9 mm is a whole number of steps
}

TEST(LockStepMotion, PassesThePathAtItsOffsetWhenTiltedToo) {
  const DrillPath path = paper_path();
  const LockStepMotion motion(path, 0.0, {.step_mm = 0.1, .offset_mm = -0.7, .tilt_deg = -20.0});
  double nearest_mm = 1e9;
  for (std::size_t i = 0; i <= motion.cycle_count(); ++i) {
    nearest_mm = std::min(nearest_mm, off_line_mm(path, motion.pose(i).tip_mm));
  }
  EXPECT_NEAR(nearest_mm, 0.7, 1e-9);
}

TEST(LockStepMotion, RefusesOptionsWithoutSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  const DrillPath path = paper_path();
  for (const double bad : {nan, 0.0, -0.001, 1e-9}) {
    EXPECT_THROW(LockStepMotion(path, 0.0, {.step_mm = bad}), Error) << bad;
  }
  for (const double bad : {nan, infinite, -infinite, 1e3}) {
    EXPECT_THROW(LockStepMotion(path, 0.0, {.offset_mm = bad}), Error) << bad;
    EXPECT_THROW(LockStepMotion(path, 0.0, {.tilt_deg = bad}), Error) << bad;
  }
  for (const double bad : {nan, infinite, -0.1, -40.0}) {
    EXPECT_THROW(LockStepMotion(path, bad, {}), Error) << bad;
  }
  EXPECT_THROW(LockStepMotion({"none", Vec3::Zero(), Vec3::Zero(), {}}, 1.0, {}), Error);
}

TEST(RunLockStep, PlacesTheBitAndThenRecordsEveryCycle) {
  const LockStepMotion motion(paper_path(), 1.2, {.step_mm = 0.5});
  Recorder engine;
  std::vector<double> shares;
  const std::vector<CycleRecord> records =
      run_lock_step(engine, motion, Progress([&](std::string_view, double share) { shares.push_back(share); }));
  ASSERT_EQ(records.size(), 78U);
  ASSERT_EQ(engine.count, 79U);
  for (std::size_t i = 0; i < engine.count; ++i) EXPECT_EQ(engine.poses[i].tip_mm, motion.pose(i).tip_mm);
  EXPECT_EQ(records[0].removed, 2U);  // the first call places the bit and is not recorded
  EXPECT_EQ(records[77].removed, 79U);
  EXPECT_EQ(records[77].tested, 158U);
  EXPECT_EQ(records[5].removed_hu, -1);
  EXPECT_EQ(records[5].work_n_mm, 0.5F);
  EXPECT_EQ(records[5].thrust_n, 0.25F);
  EXPECT_NEAR(records[77].depth_mm, 37.8, 1e-9);
  EXPECT_NEAR(records[0].depth_mm, -0.7, 1e-9);
  EXPECT_EQ(shares.back(), 1.0);
}

TEST(RunLockStep, StopsWhenItIsCancelled) {
  const LockStepMotion motion(paper_path(), 0.0, {.step_mm = 0.01});
  Recorder engine;
  Progress progress;
  progress = Progress([&](std::string_view, double share) {
    if (share >= 0.25) progress.cancel();
  });
  EXPECT_THROW(run_lock_step(engine, motion, progress), Cancelled);
  EXPECT_LT(engine.count, 1100U);  // of 3,780: the next whole per cent stops it
}

TEST(RunLockStep, DrillsTheWholeOfANarrowVolume) {
  const DrillPath path = paper_path();
  PointVolume volume(path, {.radius_mm = 1.0, .spacing_mm = 0.2});
  const DrillBit bit{3.0, 50.0, 0.5};
  const auto engine = make_reference_engine(volume, bit, {});
  const std::vector<CycleRecord> records = run_lock_step(*engine, LockStepMotion(path, 0.0, {.step_mm = 0.01}));
  const std::size_t removed = std::accumulate(records.begin(), records.end(), std::size_t{0},
                                              [](std::size_t sum, const CycleRecord& r) { return sum + r.removed; });
  // The first disc dies in part where the bit is placed, before the first cycle: its centre.
  EXPECT_EQ(removed + volume.alive_count() + 1, volume.point_count());
  // Only the last discs, within the cone of 0.5 mm, keep points.
  EXPECT_LT(volume.alive_count(), 3 * volume.pattern().point_count());
}

}  // namespace
}  // namespace spinaltap
