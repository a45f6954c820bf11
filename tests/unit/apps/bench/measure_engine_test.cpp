#include "apps/spinaltap/bench/measure_engine.h"

#include <gtest/gtest.h>

#include "apps/spinaltap/bench/drill_workload.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

/// The first 2,000 cycles into the coarsest cylinder.
class MeasureEngine : public testing::Test {
 protected:
  MeasureEngine() { poses_.resize(2'001); }

  EngineRun run(EngineFactory make_engine) const { return {std::move(make_engine), workload_path(3.0).bit, poses_}; }

  std::vector<Pose> poses_ = workload_poses(WorkloadMotion::tremor);
  PointVolume volume_ = workload_volume(0.2);
  ClockCosts costs_ = measure_clock_costs();
};

/// Leaves one point occupied that the ring engine removes.
class Forgetful final : public DrillEngine {
 public:
  Forgetful(PointVolume& volume, const DrillBit& bit, const Material& material)
      : volume_(volume), engine_(make_ring_engine(volume, bit, material)) {}
  StepResult step(const Pose& pose) noexcept override {
    const StepResult result = engine_->step(pose);
    volume_.set_occupied(1, 0, true);
    return result;
  }
  void reset_motion() noexcept override { engine_->reset_motion(); }
  std::size_t memory_bytes() const override { return 0; }

 private:
  PointVolume& volume_;
  std::unique_ptr<DrillEngine> engine_;
};

EngineFactory forgetful() {
  return [](PointVolume& volume, const DrillBit& bit, const Material& material) {
    return std::make_unique<Forgetful>(volume, bit, material);
  };
}

TEST_F(MeasureEngine, CountsEveryCycleOfTheWholePath) {
  const EngineMeasurement measured = measure_whole_path(run(make_ring_engine), volume_, costs_);
  EXPECT_TRUE(measured.is_whole_path);
  EXPECT_EQ(measured.curve.size(), 100U);
  EXPECT_EQ(measured.all.end - measured.all.begin, 2'000U);
  EXPECT_EQ(measured.first_tenth.end, 200U);
  EXPECT_EQ(measured.middle_tenth.begin, 900U);
  EXPECT_EQ(measured.last_tenth.begin, 1'800U);
  EXPECT_EQ(measured.cycles, 2'000U);
  // The step to the first pose is not a cycle.
  const std::size_t dead = volume_.point_count() - volume_.occupied_count();
  EXPECT_LE(measured.all.removed, dead);
  EXPECT_GT(measured.all.removed, dead / 2);
  EXPECT_LE(measured.cpu.p50_us, measured.cpu.p99_us);
  EXPECT_LE(measured.cpu.p999_us, measured.cpu.max_us);
  EXPECT_GT(measured.memory_bytes, volume_.memory_bytes());
}

TEST_F(MeasureEngine, LeavesTheSamePointsOccupiedWithEveryEngine) {
  const auto reference = measure_whole_path(run(make_reference_engine), volume_, costs_);
  const auto ring = measure_whole_path(run(make_ring_engine), volume_, costs_);
  EXPECT_EQ(reference.occupancy_hash, ring.occupancy_hash);
  EXPECT_EQ(reference.all.removed, ring.all.removed);
  EXPECT_NE(ring.occupancy_hash, measure_whole_path(run(forgetful()), volume_, costs_).occupancy_hash);
}

TEST_F(MeasureEngine, RemovesInWindowsWhatTheWholePathRemovesThere) {
  const auto windows = measure_windows(run(make_reference_engine), volume_, costs_, {.cycles = 100});
  const auto whole = measure_whole_path(run(make_ring_engine), volume_, costs_);
  EXPECT_FALSE(windows.is_whole_path);
  EXPECT_EQ(windows.curve.size(), 11U);  // the middles of tenths, and the path's
  EXPECT_EQ(windows.cycles, 1'100U);
  EXPECT_EQ(windows.last_tenth.begin, 1'850U);
  // The window is that of cycles 950 to 1,050; hundredths of the path, of 20 cycles, lie in it from 960 to 1,040.
  std::size_t removed = 0;
  for (const Stretch& stretch : whole.curve) {
    if (stretch.begin >= 960 && stretch.end <= 1'040) removed += stretch.removed;
  }
  EXPECT_GE(windows.middle_tenth.removed, removed);
}

TEST_F(MeasureEngine, RejectsEnginesThatLeaveOtherPointsInAWindow) {
  EXPECT_THROW(measure_windows(run(forgetful()), volume_, costs_, {.cycles = 50}), Error);
  EXPECT_THROW(measure_windows(run(make_ring_engine), volume_, costs_, {.cycles = 0}), Error);
  EXPECT_THROW(measure_windows(run(make_ring_engine), volume_, costs_, {.cycles = 101}), Error);
}

TEST_F(MeasureEngine, MeasuresAStepWithEveryPointOccupiedBefore) {
  const StepWorkload step = burr_step();
  const std::vector<Pose> poses{step.from, step.to};
  const EngineRun burr{make_ring_engine, step.bit, poses};
  const StepMeasurement first = measure_step(burr, volume_);
  const StepMeasurement again = measure_step(burr, volume_);
  EXPECT_GT(first.removed, 0U);
  EXPECT_EQ(first.removed, again.removed);
  EXPECT_EQ(first.occupancy_hash, again.occupancy_hash);
  EXPECT_GT(first.wall_ns, 0);
}

TEST(TimeSpread, GivesTimesThatWereMeasured) {
  std::vector<std::int64_t> samples_ns;
  for (std::int64_t n = 1'000; n >= 1; --n) samples_ns.push_back(1'000 * n);
  const TimeSpread spread = spread_of(samples_ns);
  EXPECT_EQ(spread.p50_us, 500.0);
  EXPECT_EQ(spread.p99_us, 990.0);
  EXPECT_EQ(spread.p999_us, 999.0);
  EXPECT_EQ(spread.max_us, 1'000.0);
  EXPECT_EQ(spread_of({}).max_us, 0.0);
  EXPECT_EQ(spread_of({7'000}).p50_us, 7.0);
}

TEST(ClockCosts, AreBelowAHundredMicroseconds) {
  const ClockCosts costs = measure_clock_costs();
  EXPECT_GT(costs.cpu_ns, 0);
  EXPECT_LT(costs.cpu_ns, 100'000);
  EXPECT_LT(costs.wall_ns, 100'000);
}

}  // namespace
}  // namespace spinaltap
