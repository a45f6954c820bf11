// What every engine owes to a haptic loop: no allocation, and no harm from poses that are none.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "tests/support/count_allocations.h"
#include "tests/support/nan.h"
#include "tests/unit/core/engine/askew_block.h"
#include "tests/unit/core/engine/every_engine.h"

namespace spinaltap {
namespace {

using test::block;
using test::kNan;
using test::NamedEngine;
using test::pose_at;

class EngineSteps : public ::testing::TestWithParam<NamedEngine> {
 protected:
  std::unique_ptr<DrillEngine> engine(PointVolume& volume, const DrillBit& bit) const {
    return GetParam().make(volume, bit, {});
  }
};

INSTANTIATE_TEST_SUITE_P(Engines, EngineSteps, ::testing::ValuesIn(test::every_engine()),
                         [](const auto& engine) { return engine.param.name; });

TEST_P(EngineSteps, AllocateAndThrowNothing) {
  static_assert(noexcept(std::declval<DrillEngine&>().step(std::declval<const Pose&>())));
  PointVolume volume = block(4.0, 1.5, 0.1);
  const auto drilling = engine(volume, {1.5, 10.0, 2.0});
  std::vector<Pose> poses;
  // Along, then an operator's steps: small ones all.
  for (int i = 0; i < 300; ++i) poses.push_back(pose_at(volume, Vec3(0.001 * i, 0.0, 0.003 * i)));
  for (int i = 0; i < 300; ++i) {
    const double lean = 0.0001 * i;
    poses.push_back(pose_at(volume, Vec3(0.3 - 0.002 * i, 0.001 * i, 0.9), Vec3(lean, -lean, 1.0)));
  }
  for (int i = 0; i < 100; ++i) poses.push_back(pose_at(volume, Vec3(-0.3, 0.3, 0.9 - 0.04 * i)));
  poses.push_back({Vec3::Constant(kNan), Vec3::UnitZ()});
  const std::size_t before = test::allocation_count();
  std::size_t removed = 0;
  for (const Pose& pose : poses) removed += drilling->step(pose).removed;
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_GT(removed, 300U);
  // The counter counts.
  ::operator delete(::operator new(1));
  EXPECT_EQ(test::allocation_count(), before + 1);
}

TEST_P(EngineSteps, ChangeNothingAtPosesThatAreNone) {
  PointVolume volume = block(4.0, 1.0, 0.1);
  const DrillBit bit{1.0, 10.0, 2.0};
  const auto drilling = engine(volume, bit);
  std::vector<Pose> bad;
  const Pose good = pose_at(volume, Vec3(0, 0, 3.0));
  const double infinite = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    for (const double number : {kNan, infinite, -infinite}) {
      bad.push_back(good);
      bad.back().tip_mm[axis] = number;
      bad.push_back(good);
      bad.back().axis[axis] = number;
    }
    for (const double far_mm : {-1.01e4, 1.01e4, 1e300}) {
      Vec3 tip_mm(0, 0, 3);
      tip_mm[axis] = far_mm;
      bad.push_back(pose_at(volume, tip_mm));
    }
  }
  bad.push_back({good.tip_mm, Vec3::Zero()});
  for (const double length : {2.0, 0.5, 1.0 + 2e-6, 1.0 - 2e-6}) bad.push_back({good.tip_mm, length * good.axis});

  const auto expect_nothing = [&] {
    const std::uint64_t occupied = test::hash_of_occupied(volume);
    for (const Pose& pose : bad) {
      const StepResult result = drilling->step(pose);
      EXPECT_EQ(result.removed, 0U);
      EXPECT_EQ(result.tested, 0U);
      EXPECT_EQ(result.work_n_mm, 0.0);
    }
    EXPECT_EQ(test::hash_of_occupied(volume), occupied);
  };
  expect_nothing();  // before the bit is placed
  drilling->step(pose_at(volume, Vec3(0, 0, 1.0)));
  expect_nothing();
  // The bit is still where it was, and goes on from there: the same as without the bad poses.
  PointVolume undisturbed = block(4.0, 1.0, 0.1);
  const auto other = engine(undisturbed, bit);
  EXPECT_GT(other->step(pose_at(volume, Vec3(0, 0, 1.0))).removed, 0U);
  EXPECT_EQ(drilling->step(good).removed, other->step(good).removed);
  EXPECT_EQ(test::hash_of_occupied(volume), test::hash_of_occupied(undisturbed));
}

TEST_P(EngineSteps, SurviveWaysOfTensOfMetres) {
  PointVolume volume = block(4.0, 1.0, 0.1);
  const auto drilling = engine(volume, {1.0, 10.0, 2.0});
  drilling->step(pose_at(volume, Vec3(-9'999.0, 0.0, 2.05)));
  EXPECT_EQ(volume.occupied_count(), volume.point_count());
  EXPECT_GT(drilling->step(pose_at(volume, Vec3(9'999.0, 0.0, 2.05))).removed, 1'000U);
  // Passed across: at 1 mm behind the tip the bit is 0.25 mm to both sides. Positions of 10 m hold 2 nm.
  for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) {
    const double off_mm = std::abs(volume.pattern().point_mm(i).y());
    if (std::abs(off_mm - 0.2625) < 1e-4) continue;
    EXPECT_EQ(volume.is_occupied(10, i), off_mm > 0.2625) << off_mm;
  }
}

TEST_P(EngineSteps, TakeTheFirstPoseWithoutAWayAndRemoveNothingTwice) {
  PointVolume volume = block(4.0, 1.0, 0.1);
  const auto drilling = engine(volume, {1.0, 1.5, 0.5});
  // Nothing lies between the volume's start and the bit, were it to come from there: it is placed beyond.
  const StepResult first = drilling->step(pose_at(volume, Vec3(0, 0, 3.5)));
  EXPECT_GT(first.removed, 100U);
  for (int disc = 0; disc < 20; ++disc) ASSERT_TRUE(volume.is_occupied(disc, 0)) << disc;
  EXPECT_EQ(volume.occupied_count() + first.removed, volume.point_count());
  EXPECT_EQ(drilling->step(pose_at(volume, Vec3(0, 0, 3.5))).removed, 0U);
}

TEST_P(EngineSteps, RejectABitOrAMaterialThatIsNone) {
  PointVolume volume = block(1.0, 1.0, 0.1);
  EXPECT_THROW(GetParam().make(volume, {kNan, 50.0, 5.0}, {}), Error);
  EXPECT_THAT([&] { GetParam().make(volume, plate_bit(2.0, 0.5, 50.0), {}); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("an engine of points, found a plate")));
  Material material;
  material.specific_cutting_energy_mpa = kNan;
  EXPECT_THROW(GetParam().make(volume, {}, material), Error);
}

}  // namespace
}  // namespace spinaltap
