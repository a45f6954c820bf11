// Compiled with optimisation: long loops of its own.

#include "vdb/remaining/detail/bit_sweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/tool/swept_bit.h"
#include "tests/unit/core/engine/tools.h"

namespace spinaltap {
namespace {

using test::Draw;
using test::Tool;

TEST(MeridianOutline, IsTheProfilesDistance) {
  Draw draw(3);
  for (const Tool& tool : test::every_tool()) {
    SCOPED_TRACE(tool.name);
    const BitProfile profile(tool.bit);
    const detail::BitOutline outline(profile);
    for (int n = 0; n < 5000; ++n) {
      const double back_mm = draw(-1.0, profile.length_mm() + 1.0);
      const double off_mm = draw(0.0, 2.0);
      ASSERT_NEAR(outline.whole().at(back_mm, off_mm).distance_mm, profile.distance_mm(back_mm, off_mm), 1e-12);
    }
  }
}

TEST(MeridianOutline, HasASlopeOfOneThatPredictsTheNextValue) {
  Draw draw(4);
  for (const Tool& tool : test::every_tool()) {
    SCOPED_TRACE(tool.name);
    const detail::BitOutline outline{BitProfile(tool.bit)};
    int kinks = 0;
    for (int n = 0; n < 5000; ++n) {
      const double back_mm = draw(-1.0, 5.0);
      const double off_mm = draw(0.01, 2.0);
      constexpr double kStepMm = 1e-5;
      const auto sample = outline.whole().at(back_mm, off_mm);
      ASSERT_NEAR(std::hypot(sample.per_back, sample.per_off), 1.0, 1e-9);
      const double slope_back = (outline.whole().at(back_mm + kStepMm, off_mm).distance_mm -
                                 outline.whole().at(back_mm - kStepMm, off_mm).distance_mm) /
                                (2.0 * kStepMm);
      // Where two parts are as near, the slope jumps: a line in the plane, met by one in thousands.
      kinks += std::abs(slope_back - sample.per_back) > 1e-3 ? 1 : 0;
    }
    EXPECT_LT(kinks, 25);
  }
}

/// Poses near the origin, small moves with turns.
std::vector<Pose> small_way(Draw& draw, std::size_t count) {
  std::vector<Pose> poses{{draw.within(-Vec3::Ones(), Vec3::Ones()), draw.direction()}};
  while (poses.size() < count) {
    Pose pose = poses.back();
    pose.tip_mm += 0.2 * draw.direction();
    pose.axis = (pose.axis + 0.002 * draw.direction()).normalized();
    poses.push_back(pose);
  }
  return poses;
}

TEST(BitSweep, FindsTheLeastDistanceOverTheWay) {
  Draw draw(5);
  for (const Tool& tool : test::every_tool()) {
    SCOPED_TRACE(tool.name);
    const BitProfile profile(tool.bit);
    const auto outline = std::make_shared<const detail::BitOutline>(profile);
    for (int way = 0; way < 20; ++way) {
      const std::vector<Pose> poses = small_way(draw, 4);
      const detail::BitSweep sweep(outline, poses);
      for (int n = 0; n < 100; ++n) {
        const Vec3 p = test::point_near(profile, poses[1], draw);
        double min_mm = 1e9;
        constexpr int kSteps = 200;
        for (std::size_t k = 0; k + 1 < poses.size(); ++k) {
          for (int step = 0; step <= kSteps; ++step) {
            const double t = static_cast<double>(step) / kSteps;
            const Pose between{poses[k].tip_mm + t * (poses[k + 1].tip_mm - poses[k].tip_mm),
                               (poses[k].axis + t * (poses[k + 1].axis - poses[k].axis)).normalized()};
            min_mm = std::min(min_mm, bit_distance_mm(profile, between, p));
          }
        }
        const detail::SweepSample sample = sweep.nearest(p);
        // Chord and arc part by angle (angle r + 2 way) / 8 at most: 0.0001 mm.
        if (min_mm > 0.0) {
          ASSERT_NEAR(sample.distance_mm, min_mm, 5e-6 + 0.002 * (0.002 * 5.5 + 2.0 * 0.2) / 8.0) << p.transpose();
          ASSERT_NEAR(sample.gradient.norm(), 1.0, 1e-6);
        } else {
          ASSERT_LE(sample.distance_mm, 1.1e-4) << p.transpose();
        }
      }
    }
  }
}

TEST(BitSweep, BoundsHowDistancesChange) {
  Draw draw(6);
  for (const Tool& tool : test::every_tool()) {
    SCOPED_TRACE(tool.name);
    const BitProfile profile(tool.bit);
    const auto outline = std::make_shared<const detail::BitOutline>(profile);
    for (int way = 0; way < 100; ++way) {
      const std::vector<Pose> poses = small_way(draw, 3);
      const Pose from = small_way(draw, 1)[0];
      const detail::BitSweep sweep(outline, poses);
      const Vec3 middle = test::point_near(profile, from, draw);
      const double around_mm = draw(0.0, 0.5);
      const double bound_mm = sweep.change_mm(from, middle, around_mm, 0.3);
      for (int n = 0; n < 20; ++n) {
        const Vec3 p = middle + draw(0.0, around_mm) * draw.direction();
        const double before_mm = bit_distance_mm(profile, from, p);
        // The wall's bound is for points near the bit only.
        if (std::abs(before_mm) > 0.3) continue;
        for (const Pose& pose : poses) {
          ASSERT_LE(std::abs(bit_distance_mm(profile, pose, p) - before_mm), bound_mm + 1e-9);
        }
      }
    }
  }
}

TEST(CutIntoSweeps, PassesEveryPoseWithinTheTolerance) {
  constexpr double kToleranceMm = 0.001;
  Draw draw(7);
  const DrillBit bit{3.0, 50.0, 5.0};
  const BitProfile profile(bit);
  std::vector<Pose> poses;
  // An operator's tremor, which turns: 10 Hz, 0.1 mm, at 1 kHz.
  const Vec3 axis = Vec3(0.2, -0.5, 0.8).normalized();
  for (int n = 0; n < 200; ++n) {
    const double phase = 2.0 * std::numbers::pi * 0.01 * n;
    poses.push_back({Vec3(0.1 * std::sin(phase), 0.1 * std::cos(1.1 * phase), 0.001 * n),
                     (axis + 1e-3 * Vec3(std::sin(phase), 0.0, 0.0)).normalized()});
  }
  const auto sweeps = detail::cut_into_sweeps(bit, poses, kToleranceMm, 1.0);
  std::size_t moments = 0;
  for (const auto& sweep : sweeps) moments += sweep.moment_count();
  EXPECT_LT(moments, poses.size() / 2);
  for (const Pose& pose : poses) {
    for (int n = 0; n < 10; ++n) {
      const Vec3 p = test::point_near(profile, pose, draw);
      double min_mm = 1e9;
      for (const auto& sweep : sweeps) min_mm = std::min(min_mm, sweep.nearest(p).distance_mm);
      ASSERT_LE(min_mm, bit_distance_mm(profile, pose, p) + 2.0 * kToleranceMm);
    }
  }
}

TEST(CutIntoSweeps, TakesAWayAlongTheAxisOfABitThatIsWiderAgainBehindItsNeck) {
  Draw draw(8);
  const DrillBit bit =
      profile_bit({{0.0, 0.0}, {1.5, 1.5, true}, {3.8, 1.5}, {4.6, 0.9}, {8.0, 0.9}, {9.0, 1.2}, {20.0, 1.2}});
  const BitProfile profile(bit);
  constexpr double kWayMm = 6.0;
  const Vec3 axis = Vec3(0.3, 0.8, -0.5).normalized();
  const std::vector<Pose> poses{{Vec3::Zero(), axis}, {kWayMm * axis, axis}};
  const auto sweeps = detail::cut_into_sweeps(bit, poses, 0.001, 1.0);
  for (int n = 0; n < 500; ++n) {
    const Pose between{draw(0.0, kWayMm) * axis, axis};
    const Vec3 p = test::point_near(profile, between, draw);
    double min_mm = 1e9;
    constexpr int kPoses = 3000;
    for (int k = 0; k <= kPoses; ++k)
      min_mm = std::min(min_mm, bit_distance_mm(profile, {k * kWayMm / kPoses * axis, axis}, p));
    double found_mm = 1e9;
    for (const auto& sweep : sweeps) found_mm = std::min(found_mm, sweep.nearest(p).distance_mm);
    // Poses 2 um apart miss the nearest by half of that.
    if (min_mm > 0.0) {
      ASSERT_NEAR(found_mm, min_mm, 1.1e-3) << p.transpose();
    } else {
      ASSERT_LE(found_mm, 1.1e-3) << p.transpose();
    }
  }
}

TEST(CutIntoSweeps, TakesALongStraightWayAsOneLongerBit) {
  const DrillBit bit{3.0, 50.0, 5.0};
  const std::vector<Pose> poses{{Vec3::Zero(), Vec3::UnitX()}, {Vec3(20.0, 0.0, 0.0), Vec3::UnitX()}};
  const auto sweeps = detail::cut_into_sweeps(bit, poses, 0.001, 1.0);
  ASSERT_EQ(sweeps.size(), 1U);
  EXPECT_EQ(sweeps[0].moment_count(), 1U);
  EXPECT_NEAR(sweeps[0].outline().length_mm(), 70.0, 1e-9);
}

}  // namespace
}  // namespace spinaltap
