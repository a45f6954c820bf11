#include "vdb/sim/replay.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "tests/support/analytic_bodies.h"
#include "vdb/detail/bone_grids.h"

namespace spinaltap {
namespace {

using test::kBall;

const DrillBit kRecordedBit{4.0, 40.0, 2.0};
constexpr double kRecordedJumpMm = 1.0;

const BoneModel& undrilled_ball() {
  static const BoneModel bone = test::bake_ball(kBall, 0.25);
  return bone;
}

/// Down through the middle at 10 mm/s, 100 cycles a second, from 12 mm above to 4 mm below it.
SessionRecord record_of_a_straight_hole() {
  SessionRecord record;
  for (int n = 0; n <= 160; ++n) {
    RecordedCycle cycle;
    cycle.cycle = static_cast<std::uint64_t>(n);
    cycle.dt_s = 0.01;
    cycle.time_s = 0.01 * n;
    cycle.tip_mm = kBall.centre_mm + Vec3(0.0, 0.0, 12.0 - 0.1 * n);
    cycle.axis = -Vec3::UnitZ();
    record.cycles.push_back(cycle);
  }
  return record;
}

bool is_left(const BoneModel& bone, double z_mm) {
  const Vec3 p_mm = kBall.centre_mm + Vec3(0.0, 0.0, z_mm);
  std::uint8_t inside = 0;
  bone.inside({&p_mm, 1}, {&inside, 1});
  return inside != 0;
}

/// The deepest place on the axis that is drilled, to 0.1 mm.
double bottom_mm(const BoneModel& bone) {
  double z_mm = 9.5;
  while (z_mm > -9.5 && !is_left(bone, z_mm)) z_mm -= 0.05;
  return z_mm;
}

TEST(RecordedHole, IsAsDeepAsTheTipWasAtAnyMoment) {
  const SessionRecord record = record_of_a_straight_hole();
  RecordedHole hole(undrilled_ball(), record, kRecordedBit, kRecordedJumpMm);
  EXPECT_DOUBLE_EQ(hole.end_s(), 1.6);
  EXPECT_TRUE(is_left(hole.drilled(), 9.5));
  // Forward, backward, beyond the end and before the begin.
  for (const double time_s : {0.5, 1.0, 0.7, 1.6, 1.1, 99.0, 0.9}) {
    hole.go_to(time_s + 1e-6);
    const double tip_mm = 12.0 - 10.0 * std::min(time_s, 1.6);
    EXPECT_NEAR(hole.pose().tip_mm.z(), kBall.centre_mm.z() + tip_mm, 1e-9);
    // The cone's tip is narrower than a voxel over its last 0.1 mm.
    EXPECT_NEAR(bottom_mm(hole.drilled()), tip_mm, 0.3) << time_s;
  }
  hole.go_to(0.0);
  EXPECT_TRUE(is_left(hole.drilled(), 9.5));
}

TEST(RecordedHole, IsTheSameForwardAndAfterGoingBack) {
  const SessionRecord record = record_of_a_straight_hole();
  RecordedHole forward(undrilled_ball(), record, kRecordedBit, kRecordedJumpMm);
  RecordedHole restless(undrilled_ball(), record, kRecordedBit, kRecordedJumpMm);
  forward.go_to(1.2);
  for (const double time_s : {1.5, 0.3, 1.2}) restless.go_to(time_s);
  std::size_t differ = 0;
  const openvdb::FloatGrid& a = *forward.drilled().grids().sdf;
  for (auto voxel = a.cbeginValueOn(); voxel; ++voxel) {
    const float other = restless.drilled().grids().sdf->tree().getValue(voxel.getCoord());
    differ += std::abs(*voxel - other) > 1e-5F ? 1U : 0U;
  }
  EXPECT_EQ(differ, 0U);
}

TEST(RecordedHole, NeedsACycle) {
  const SessionRecord none;
  EXPECT_THROW(RecordedHole(undrilled_ball(), none, kRecordedBit, kRecordedJumpMm), Error);
}

}  // namespace
}  // namespace spinaltap
