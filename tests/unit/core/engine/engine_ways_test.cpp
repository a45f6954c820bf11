// What every engine owes to sweeping: what a bit passes dies, whatever the steps, and nothing else does.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/test_kind.h"
#include "tests/unit/core/engine/every_engine.h"
#include "tests/unit/core/engine/tools.h"

namespace spinaltap {
namespace {

using test::block;
using test::Draw;
using test::NamedEngine;
using test::pose_at;

class EngineWays : public ::testing::TestWithParam<NamedEngine> {
 protected:
  std::unique_ptr<DrillEngine> engine(PointVolume& volume, const DrillBit& bit) const {
    return GetParam().make(volume, bit, {});
  }
};

INSTANTIATE_TEST_SUITE_P(Engines, EngineWays, ::testing::ValuesIn(test::three_engines()),
                         [](const auto& engine) { return engine.param.name; });

SLOW_TESTS("EngineWays.*");

TEST_P(EngineWays, LeaveNothingInAJumpSidewaysThatSmallStepsRemove) {
  const DrillBit bit{3.0, 50.0, 5.0};
  constexpr double kOffMm = 0.1;
  // 3.0 mm: the tip stays in a disc's plane.
  for (const double depth_mm : {3.0, 3.02}) {
    const Vec3 begin_mm(-1.2, kOffMm, depth_mm);
    const Vec3 end_mm(1.2, kOffMm, depth_mm);
    PointVolume jumped = block(4.0, 3.0, 0.15);
    PointVolume walked = jumped;
    const auto jumper = engine(jumped, bit);
    jumper->step(pose_at(jumped, begin_mm));
    const std::size_t at_begin = jumped.occupied_count();
    jumper->step(pose_at(jumped, end_mm));
    const auto walker = engine(walked, bit);
    for (int i = 0; i <= 2400; ++i) {
      walker->step(pose_at(walked, begin_mm + i / 2400.0 * (end_mm - begin_mm)));
    }
    EXPECT_TRUE(test::lives_within(jumped, walked)) << depth_mm;
    EXPECT_EQ(jumped.occupied_count(), walked.occupied_count()) << depth_mm;
    EXPECT_LT(jumped.occupied_count() + 1'500, at_begin);
  }
}

TEST_P(EngineWays, LeaveNothingInAJumpOfAnyToolThatSmallStepsRemove) {
  constexpr std::uint64_t kSeed = 2400;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  Draw draw(kSeed);
  for (const test::Tool& tool : test::every_tool()) {
    SCOPED_TRACE(tool.name);
    std::size_t removed = 0;
    for (int n = 0; n < 6; ++n) {
      const Vec3 begin_mm = draw.within(Vec3(-1.2, -1.2, -0.5), Vec3(1.2, 1.2, 3.0));
      const Vec3 end_mm = begin_mm + 2.4 * draw.direction();
      const Vec3 axis = (Vec3::UnitZ() + 0.5 * draw.direction()).normalized();
      PointVolume jumped = block(3.0, 1.5, 0.15);
      PointVolume walked = jumped;
      const auto jumper = engine(jumped, tool.bit);
      jumper->step(pose_at(jumped, begin_mm, axis));
      jumper->step(pose_at(jumped, end_mm, axis));
      const auto walker = engine(walked, tool.bit);
      for (int i = 0; i <= 1200; ++i) {
        walker->step(pose_at(walked, begin_mm + i / 1200.0 * (end_mm - begin_mm), axis));
      }
      EXPECT_TRUE(test::lives_within(jumped, walked)) << n;
      EXPECT_EQ(jumped.occupied_count(), walked.occupied_count()) << n;
      removed += jumped.point_count() - jumped.occupied_count();
    }
    EXPECT_GT(removed, 1'000U);
  }
}

/// Wider by `more_mm` all along, and longer.
DrillBit larger(DrillBit bit, double more_mm) {
  if (bit.shape == BitShape::profile) {
    for (OutlinePoint& point : bit.outline) {
      if (point.radius_mm > 0.0) point.radius_mm += 0.5 * more_mm;
    }
    bit.outline.back().back_mm += more_mm;
    return profile_bit(bit.outline);
  }
  bit.diameter_mm += more_mm;
  bit.length_mm += more_mm;
  if (bit.shank_diameter_mm > 0.0) bit.shank_diameter_mm += 0.5 * more_mm;
  return bit;
}

TEST_P(EngineWays, RemoveMoreWithALargerBit) {
  constexpr std::uint64_t kSeed = 333;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  for (const test::Tool& tool : test::every_tool()) {
    SCOPED_TRACE(tool.name);
    std::vector<PointVolume> volumes;
    for (const double more_mm : {0.0, 0.1, 0.35, 1.0}) {
      const DrillBit bit = larger(tool.bit, more_mm);
      volumes.push_back(block(3.0, 1.5, 0.15));
      const auto drilling = engine(volumes.back(), bit);
      test::RandomOperator tool_operator(kSeed, 3.0, 1.0);
      for (int step = 0; step < 40; ++step) drilling->step(tool_operator.next(volumes.back()));
    }
    for (std::size_t n = 1; n < volumes.size(); ++n) {
      EXPECT_TRUE(test::lives_within(volumes[n], volumes[n - 1])) << n;
      EXPECT_LT(volumes[n].occupied_count(), volumes[n - 1].occupied_count()) << n;
    }
    EXPECT_LT(volumes[0].occupied_count(), volumes[0].point_count());
  }
}

TEST_P(EngineWays, RemoveTheSameFromOnePoseToAnotherAndBack) {
  constexpr std::uint64_t kSeed = 12;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  Draw draw(kSeed);
  for (const test::Tool& tool : test::every_tool()) {
    SCOPED_TRACE(tool.name);
    for (int n = 0; n < 12; ++n) {
      PointVolume there = block(3.0, 1.5, 0.15);
      PointVolume back = there;
      const Vec3 axis = (Vec3::UnitZ() + 0.5 * draw.direction()).normalized();
      // Two of three turn.
      const Vec3 turned = n % 3 == 0 ? axis : Vec3((axis + 0.02 * draw.direction()).normalized());
      const Pose a = pose_at(there, draw.within(Vec3(-1, -1, 0), Vec3(1, 1, 3)), axis);
      const Pose b = pose_at(there, draw.within(Vec3(-1, -1, 0), Vec3(1, 1, 3)), turned);
      const auto first = engine(there, tool.bit);
      first->step(a);
      first->step(b);
      const auto second = engine(back, tool.bit);
      second->step(b);
      second->step(a);
      EXPECT_EQ(test::hash_of_occupied(there), test::hash_of_occupied(back)) << n;
      EXPECT_LT(there.occupied_count(), there.point_count()) << n;
    }
  }
}

TEST_P(EngineWays, TakeARingOnWhichTheBitsWallLiesWhateverThePathsDirection) {
  constexpr std::uint64_t kSeed = 15;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  Draw draw(kSeed);
  const DrillBit bit{3.0, 50.0, 1.0};
  for (int n = 0; n < 24; ++n) {
    const Vec3 entry_mm = draw.within(Vec3(-900, -900, -1900), Vec3(900, 900, 900));
    PointVolume volume({"any", entry_mm, entry_mm + 4.0 * draw.direction(), bit},
                       {.radius_mm = 2.0, .spacing_mm = 0.1});
    const auto drilling = engine(volume, bit);
    double depth_mm = -0.05;
    while (depth_mm < 3.0) {
      drilling->step(pose_at(volume, Vec3(0, 0, depth_mm)));
      depth_mm += draw(0.001, 0.4);
    }
    drilling->step(pose_at(volume, Vec3(0, 0, 3.0417)));
    for (int disc = 0; disc < volume.disc_count(); ++disc) {
      // Behind the cone, rings up to 15, 1.5 mm; in it, those within the cone.
      const double back_mm = 3.0417 - volume.disc_depth_mm(disc);
      const int last_ring = static_cast<int>(std::floor(10.0 * std::min(1.5, 1.5 * back_mm) + 1e-6));
      for (int ring = 0; ring < volume.pattern().ring_count(); ++ring) {
        const std::size_t start = DiscPattern::ring_start(ring);
        for (std::size_t i = start; i < start + DiscPattern::ring_size(ring); ++i) {
          ASSERT_EQ(volume.is_occupied(disc, i), back_mm < 0.0 || ring > last_ring)
              << "disc " << disc << " ring " << ring;
        }
      }
    }
  }
}

}  // namespace
}  // namespace spinaltap
