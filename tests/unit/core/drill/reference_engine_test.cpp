#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/drill/drill_engine.h"
#include "tests/unit/core/drill/count_allocations.h"

namespace spinaltap {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Volumes lie askew and away from the origin, so that no frame is the identity.
DrillPath askew_path(double length_mm) {
  const Vec3 entry_mm(81.0, -143.0, 412.0);
  return {"askew", entry_mm, entry_mm + length_mm * Vec3(0.48, -0.64, 0.6), {}};
}

PointVolume block(double length_mm, double radius_mm, double spacing_mm, std::int16_t hu = 1000) {
  PointVolume volume(askew_path(length_mm), {.radius_mm = radius_mm, .spacing_mm = spacing_mm});
  std::ranges::fill(volume.hu(), hu);
  return volume;
}

/// A pose from path-local numbers.
Pose pose_at(const PointVolume& volume, const Vec3& tip_path_mm, const Vec3& axis_path = Vec3::UnitZ()) {
  return volume.frame().to_patient(Pose{tip_path_mm, axis_path.normalized()});
}

/// The rule without any cleverness: every point, at every pose on the way.
class BruteForce {
 public:
  BruteForce(PointVolume& volume, const DrillBit& bit) : volume_(volume), bit_(bit) {}

  std::size_t step(const Pose& pose_patient) {
    const Pose target = volume_.frame().to_path(pose_patient);
    if (!placed_) pose_ = target;
    placed_ = true;
    const Pose start = pose_;
    // The engine's rule: poses at most half a spacing apart at the tip and, by the turn, at the base.
    const double way_mm = (target.tip_mm - start.tip_mm).norm() + bit_.length_mm * (target.axis - start.axis).norm();
    const int poses = std::max(1, static_cast<int>(std::ceil(way_mm / (0.5 * volume_.pattern().spacing_mm()))));
    std::size_t removed = 0;
    for (int i = 1; i <= poses; ++i) {
      const double t = static_cast<double>(i) / poses;
      pose_ = i == poses ? target
                         : Pose{start.tip_mm + t * (target.tip_mm - start.tip_mm),
                                (start.axis + t * (target.axis - start.axis)).normalized()};
      for (int disc = 0; disc < volume_.disc_count(); ++disc) {
        for (std::size_t n = 0; n < volume_.pattern().point_count(); ++n) {
          std::uint8_t& alive = volume_.alive()[volume_.disc_start(disc) + n];
          if (alive == 0 || !bit_contains(bit_, pose_, volume_.point_in_path_mm(disc, n))) continue;
          alive = 0;
          ++removed;
        }
      }
    }
    return removed;
  }

 private:
  PointVolume& volume_;
  DrillBit bit_;
  Pose pose_;
  bool placed_ = false;
};

/// A hand without purpose: the tip is drawn towards a place that jumps now and then, in, beside and outside the volume;
/// the axis leans up to 40 degrees.
class RandomHand {
 public:
  RandomHand(std::uint64_t seed, double length_mm, double reach_mm)
      : seed_(seed), length_mm_(length_mm), reach_mm_(reach_mm), tip_mm_(0.0, 0.0, -0.5) {}

  Pose next(const PointVolume& volume) {
    if (step_++ % 25 == 0) {
      const double angle = uniform(0.0, 2.0 * std::numbers::pi);
      const double off_mm = uniform(0.0, 1.5 * reach_mm_);
      goal_mm_ = Vec3(off_mm * std::cos(angle), off_mm * std::sin(angle), uniform(-0.5 * length_mm_, 1.3 * length_mm_));
      tilt_goal_ = uniform(0.0, 40.0) * std::numbers::pi / 180.0;
      lean_ = uniform(0.0, 2.0 * std::numbers::pi);
    }
    tip_mm_ += uniform(0.0, 0.2) * (goal_mm_ - tip_mm_);
    tilt_ += 0.1 * (tilt_goal_ - tilt_);
    return pose_at(volume, tip_mm_,
                   Vec3(std::sin(tilt_) * std::cos(lean_), std::sin(tilt_) * std::sin(lean_), std::cos(tilt_)));
  }

 private:
  double uniform(double low, double high) { return low + (high - low) * random_uniform(seed_, draws_++); }

  std::uint64_t seed_;
  std::uint64_t draws_ = 0;
  double length_mm_, reach_mm_;
  Vec3 tip_mm_;
  Vec3 goal_mm_ = Vec3::Zero();
  double tilt_ = 0.0, tilt_goal_ = 0.0, lean_ = 0.0;
  int step_ = 0;
};

class ReferenceEngineMotion : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(ReferenceEngineMotion, RemovesWhatEveryPointAtEveryPoseRemoves) {
  RecordProperty("seed", static_cast<int>(GetParam()));
  SCOPED_TRACE(::testing::Message() << "seed " << GetParam());
  // Short stout bits, so that their base and shoulder pass through the volume too.
  const DrillBit bit{1.0 + 0.2 * static_cast<double>(GetParam() % 3), 3.0, 1.0};
  PointVolume volume = block(2.0, 1.2, 0.1);
  PointVolume truth = volume;
  const auto engine = make_reference_engine(volume, bit, {});
  BruteForce brute(truth, bit);
  RandomHand hand(GetParam(), 2.0, 1.2);
  std::size_t removed_in_all = 0;
  for (int step = 0; step < 120; ++step) {
    const Pose pose = hand.next(volume);
    const std::vector<std::uint8_t> before(volume.alive().begin(), volume.alive().end());
    const StepResult result = engine->step(pose);
    ASSERT_EQ(result.removed, brute.step(pose)) << step;
    ASSERT_TRUE(std::ranges::equal(volume.alive(), truth.alive())) << step;
    // Only the living die, each is counted, and none comes back.
    std::size_t died = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      ASSERT_LE(volume.alive()[i], before[i]);
      died += before[i] != volume.alive()[i];
    }
    ASSERT_EQ(result.removed, died);
    ASSERT_EQ(result.removed_hu, 1000 * static_cast<std::int64_t>(died));
    ASSERT_GE(result.tested, result.removed);
    removed_in_all += died;
  }
  // The hand did drill.
  EXPECT_GT(removed_in_all, volume.point_count() / 20);
}

INSTANTIATE_TEST_SUITE_P(Seeds, ReferenceEngineMotion, ::testing::Values(1, 2, 3, 4, 5, 6, 7, 8));

TEST(ReferenceEngine, RemovesNothingWhenTheBitIsOutside) {
  PointVolume volume = block(4.0, 1.0, 0.1);
  const auto engine = make_reference_engine(volume, {1.0, 10.0, 2.0}, {});
  for (int i = 0; i < 100; ++i) {
    // Before the entry, then past the volume's side at 0.05 mm, then behind its end.
    engine->step(pose_at(volume, Vec3(0, 0, -0.05 * (100 - i) - 0.001)));
  }
  EXPECT_EQ(volume.alive_count(), volume.point_count());
  const auto beside = make_reference_engine(volume, {1.0, 10.0, 2.0}, {});
  for (int i = 0; i < 100; ++i) beside->step(pose_at(volume, Vec3(0, 1.45, 0.1 * i)));
  EXPECT_EQ(volume.alive_count(), volume.point_count());
}

TEST(ReferenceEngine, ChangesNothingAtPosesThatAreNone) {
  PointVolume volume = block(4.0, 1.0, 0.1);
  const auto engine = make_reference_engine(volume, {1.0, 10.0, 2.0}, {});
  engine->step(pose_at(volume, Vec3(0, 0, 1.0)));
  const std::size_t alive = volume.alive_count();
  const Pose good = pose_at(volume, Vec3(0, 0, 3.0));
  const double infinite = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    for (const double bad : {kNan, infinite, -infinite}) {
      Pose pose = good;
      pose.tip_mm[axis] = bad;
      EXPECT_EQ(engine->step(pose).removed, 0U);
      pose = good;
      pose.axis[axis] = bad;
      EXPECT_EQ(engine->step(pose).removed, 0U);
    }
  }
  EXPECT_EQ(engine->step({good.tip_mm, Vec3::Zero()}).removed, 0U);
  EXPECT_EQ(engine->step({good.tip_mm, 2.0 * good.axis}).removed, 0U);
  EXPECT_EQ(volume.alive_count(), alive);
  // The bit is still where it was, and goes on from there: the same as without the bad poses.
  PointVolume undisturbed = block(4.0, 1.0, 0.1);
  const auto other = make_reference_engine(undisturbed, {1.0, 10.0, 2.0}, {});
  other->step(pose_at(volume, Vec3(0, 0, 1.0)));
  EXPECT_EQ(engine->step(good).removed, other->step(good).removed);
  EXPECT_TRUE(std::ranges::equal(volume.alive(), undisturbed.alive()));
}

TEST(ReferenceEngine, SurvivesABitThatIsTurnedRound) {
  // Half way between two opposite axes lies no axis.
  PointVolume volume = block(4.0, 1.0, 0.1);
  const auto engine = make_reference_engine(volume, {1.0, 2.0, 1.0}, {});
  engine->step(pose_at(volume, Vec3(0, 0, 1.0)));
  engine->step(pose_at(volume, Vec3(0, 0, 1.0), -Vec3::UnitZ()));
  // At the end the bit points back: the point a millimetre beyond the tip, within the cylinder, is dead.
  const std::size_t per_disc = volume.pattern().point_count();
  EXPECT_EQ(volume.alive()[25 * per_disc], 0);
  EXPECT_EQ(volume.alive()[35 * per_disc], 1);
  // Beside the tip, where both cones are narrow, nothing dies: a bit without an axis would be a ball there.
  EXPECT_EQ(volume.alive()[10 * per_disc + DiscPattern::ring_start(4)], 1);
}

TEST(ReferenceEngine, AllocatesNothingAndThrowsNothingInAStep) {
  static_assert(noexcept(std::declval<DrillEngine&>().step(std::declval<const Pose&>())));
  PointVolume volume = block(4.0, 1.5, 0.1);
  const auto engine = make_reference_engine(volume, {1.5, 10.0, 2.0}, {});
  std::vector<Pose> poses;
  RandomHand hand(3, 4.0, 1.5);
  for (int i = 0; i < 200; ++i) poses.push_back(hand.next(volume));
  poses.push_back({Vec3::Constant(kNan), Vec3::UnitZ()});
  const std::size_t before = test::allocation_count();
  std::size_t removed = 0;
  for (const Pose& pose : poses) removed += engine->step(pose).removed;
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_GT(removed, 100U);
  // The counter counts.
  ::operator delete(::operator new(1));
  EXPECT_EQ(test::allocation_count(), before + 1);
}

TEST(ReferenceEngine, LeavesOnlySliversWhenItJumpsSideways) {
  // A jump of 2.4 mm in one cycle is walked in poses at most half a spacing apart, and cusps are left between them:
  // where the bit's section has radius r, points further than sqrt(r² - (0.025 mm)²) off the tip's way may survive.
  // They are some 0.2 to 0.4% of what the bit passed through, nearly all around the tip. A step that is swept as a
  // whole would leave none; this bound says how good the sampling is.
  const DrillBit bit{3.0, 50.0, 5.0};
  constexpr double kOffMm = 0.1;
  const auto drill_in = [&](DrillEngine& engine, const PointVolume& volume, double depth_mm) {
    for (int i = 0; i <= 100; ++i) engine.step(pose_at(volume, Vec3(-1.2, kOffMm, 0.01 * depth_mm * i)));
  };
  for (const double depth_mm : {3.0, 3.02}) {
    PointVolume jumped = block(4.0, 3.0, 0.1);
    const auto jumper = make_reference_engine(jumped, bit, {});
    drill_in(*jumper, jumped, depth_mm);
    jumper->step(pose_at(jumped, Vec3(1.2, kOffMm, depth_mm)));
    for (const double step_mm : {0.005, 0.05}) {
      PointVolume walked = block(4.0, 3.0, 0.1);
      const auto walker = make_reference_engine(walked, bit, {});
      drill_in(*walker, walked, depth_mm);
      std::size_t by_walk = 0;
      const int steps = static_cast<int>(std::lround(2.4 / step_mm));
      for (int i = 1; i <= steps; ++i) {
        by_walk += walker->step(pose_at(walked, Vec3(-1.2 + 2.4 * i / steps, kOffMm, depth_mm))).removed;
      }
      std::size_t left = 0;
      for (int disc = 0; disc < walked.disc_count(); ++disc) {
        const double radius_mm = std::min(1.5, 0.3 * (depth_mm - walked.disc_depth_mm(disc)));
        for (std::size_t n = 0; n < walked.pattern().point_count(); ++n) {
          const std::size_t index = walked.disc_start(disc) + n;
          if (jumped.alive()[index] == 0 || walked.alive()[index] != 0) continue;
          ++left;
          const double off_mm = walked.point_in_path_mm(disc, n).y() - kOffMm;
          EXPECT_GE(off_mm * off_mm, radius_mm * radius_mm - 0.025 * 0.025 - 1e-9);
        }
      }
      EXPECT_LE(left, by_walk / 200) << "of " << by_walk << " at " << depth_mm << " mm by " << step_mm << " mm";
    }
  }
}

/// Work of drilling a homogeneous block from `begin_mm` to `end_mm`, over that way, N.
double mean_thrust_n(double spacing_mm, double diameter_mm, double step_mm, const Vec3& offset_mm = Vec3::Zero()) {
  constexpr double kBeginMm = 6.0;
  constexpr double kEndMm = 10.0;
  PointVolume volume = block(12.0, 3.0, spacing_mm);
  const auto engine = make_reference_engine(volume, {diameter_mm, 50.0, 5.0}, {});
  // Not to the depth itself: there discs lie, and rounding would decide about them.
  const double begin_mm = kBeginMm + 0.31 * step_mm;
  engine->step(pose_at(volume, offset_mm + Vec3(0, 0, -0.5 * spacing_mm)));
  engine->step(pose_at(volume, offset_mm + Vec3(0, 0, begin_mm)));
  double work_n_mm = 0.0;
  double push_n_mm = 0.0;
  const int steps = static_cast<int>(std::lround((kEndMm - kBeginMm) / step_mm));
  for (int i = 1; i <= steps; ++i) {
    const StepResult result = engine->step(pose_at(volume, offset_mm + Vec3(0, 0, begin_mm + step_mm * i)));
    work_n_mm += result.work_n_mm;
    push_n_mm += result.thrust_n * step_mm;
  }
  // Thrust is work over way, at every step.
  EXPECT_NEAR(push_n_mm, work_n_mm, 1e-9 * work_n_mm);
  return work_n_mm / (kEndMm - kBeginMm);
}

double section_mm2(double diameter_mm) { return 0.25 * std::numbers::pi * diameter_mm * diameter_mm; }

TEST(ReferenceEngine, PushesWithPressureTimesSectionInHomogeneousBone) {
  const double pressure_mpa = Material{}.pressure_mpa(1000.0);
  // Rings stand for bone half a spacing to either side. A radius of 1.55 mm ends between rings 15 and 16 of 0.1 mm,
  // where the rings within hold the section exactly.
  EXPECT_NEAR(mean_thrust_n(0.1, 3.1, 0.005), pressure_mpa * section_mm2(3.1), 0.01 * pressure_mpa * section_mm2(3.1));
}

TEST(ReferenceEngine, PushesTheSameWhateverTheStep) {
  const double at_5_um_n = mean_thrust_n(0.1, 3.1, 0.005);
  // All cut the same discs; a ring at either end of the way may fall to its other side: 90 of 31,000 points.
  EXPECT_NEAR(mean_thrust_n(0.1, 3.1, 0.001), at_5_um_n, 0.003 * at_5_um_n);
  EXPECT_NEAR(mean_thrust_n(0.1, 3.1, 0.020), at_5_um_n, 0.003 * at_5_um_n);
}

TEST(ReferenceEngine, PushesNearlyTheSameWhateverTheSpacingBesideThePath) {
  const double expected_n = Material{}.pressure_mpa(1000.0) * section_mm2(3.0);
  for (const double spacing_mm : {0.2, 0.1, 0.05}) {
    const double thrust_n = mean_thrust_n(spacing_mm, 3.0, 0.2, Vec3(0.83, 0.47, 0.0));
    EXPECT_NEAR(thrust_n, expected_n, 0.02 * expected_n) << spacing_mm;
  }
}

TEST(ReferenceEngine, ErrsByAtMostARingOnThePath) {
  // On the path the bit's section is cut along a whole ring, so that the section is right to half a spacing of radius
  // and no better: 6.8% at 0.1 mm. The bit of 3.0 mm ends exactly on ring 15 of 0.1 mm and ring 30 of 0.05 mm, where
  // rounding decides, anew at each pose: such points of discs passed long ago go on dying, which adds up to 2%.
  const double pressure_mpa = Material{}.pressure_mpa(1000.0);
  for (const double spacing_mm : {0.2, 0.1, 0.05}) {
    const double thrust_n = mean_thrust_n(spacing_mm, 3.0, 0.02);
    EXPECT_GE(thrust_n, 0.997 * pressure_mpa * section_mm2(3.0 - spacing_mm)) << spacing_mm;
    EXPECT_LE(thrust_n, 1.02 * pressure_mpa * section_mm2(3.0 + spacing_mm)) << spacing_mm;
  }
}

TEST(ReferenceEngine, RemovesTheBitsVolumeOnThePath) {
  PointVolume volume = block(14.0, 3.0, 0.1);
  const DrillBit bit{3.1, 50.0, 5.0};
  const auto engine = make_reference_engine(volume, bit, {});
  for (int i = 0; i <= 120; ++i) engine->step(pose_at(volume, Vec3(0, 0, 0.1 * i + 0.05)));
  double removed_mm3 = 0.0;
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    for (int ring = 0; ring < volume.pattern().ring_count(); ++ring) {
      for (std::size_t i = 0; i < DiscPattern::ring_size(ring); ++i) {
        if (volume.alive()[volume.disc_start(disc) + DiscPattern::ring_start(ring) + i] == 0) {
          removed_mm3 += volume.pattern().point_volume_mm3(ring);
        }
      }
    }
  }
  // The tip is at 12.05 mm; the first disc stands for bone from -0.05 mm on. The cone is a third of its cylinder.
  const double expected_mm3 = section_mm2(3.1) * (12.1 - 5.0 + 5.0 / 3.0);
  EXPECT_NEAR(removed_mm3, expected_mm3, 0.003 * expected_mm3);
}

TEST(ReferenceEngine, DoesNoWorkWhereNothingIsAliveAndNoThrustGoingBack) {
  PointVolume volume = block(4.0, 1.5, 0.1);
  const auto engine = make_reference_engine(volume, {1.5, 10.0, 2.0}, {});
  engine->step(pose_at(volume, Vec3(0, 0, 2.0)));
  const StepResult again = engine->step(pose_at(volume, Vec3(0, 0, 2.0)));
  EXPECT_EQ(again.removed, 0U);
  EXPECT_EQ(again.work_n_mm, 0.0);
  EXPECT_EQ(again.thrust_n, 0.0);
  const StepResult back = engine->step(pose_at(volume, Vec3(0.3, 0, 1.5)));
  EXPECT_GT(back.removed, 0U);
  EXPECT_GT(back.work_n_mm, 0.0);
  EXPECT_EQ(back.thrust_n, 0.0);
}

TEST(ReferenceEngine, RefusesABitOrAMaterialThatIsNone) {
  PointVolume volume = block(1.0, 1.0, 0.1);
  EXPECT_THROW(make_reference_engine(volume, {kNan, 50.0, 5.0}, {}), Error);
  EXPECT_THROW(make_reference_engine(volume, {}, {kNan, 0.001, 6.0, 2.0}), Error);
}

}  // namespace
}  // namespace spinaltap
