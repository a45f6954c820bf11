#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/engine/drill_engine.h"
#include "tests/support/test_kind.h"
#include "tests/unit/core/engine/askew_block.h"
#include "tests/unit/core/engine/dense_walk.h"

namespace spinaltap {
namespace {

using test::block;
using test::pose_at;
using test::RandomOperator;

class ReferenceEngineMotion : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(ReferenceEngineMotion, RemovesWhatADenseWalkHoldsAndNothingBesideIt) {
  RecordProperty("seed", static_cast<int>(GetParam()));
  SCOPED_TRACE(::testing::Message() << "seed " << GetParam());
  // Short stout bits, so that their base and shoulder pass through the volume too.
  const DrillBit bit{1.0 + 0.2 * static_cast<double>(GetParam() % 3), 3.0, 1.0};
  const BitProfile profile(bit);
  PointVolume volume = block(2.0, 1.2, 0.1);
  const auto engine = make_reference_engine(volume, bit, {});
  RandomOperator tool_operator(GetParam(), 2.0, 1.2);
  std::size_t removed_in_all = 0;
  Pose last = tool_operator.next(volume);
  engine->step(last);
  for (int step = 0; step < 120; ++step) {
    const Pose pose = tool_operator.next(volume);
    const PointVolume before = volume;
    const StepResult result = engine->step(pose);
    // Only the occupied die, each is counted, and none comes back.
    std::size_t died = 0;
    for (int disc = 0; disc < volume.disc_count(); ++disc) {
      for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) {
        ASSERT_LE(volume.is_occupied(disc, i), before.is_occupied(disc, i));
        if (!before.is_occupied(disc, i)) continue;
        constexpr double kFinestMm = 1e-3;
        constexpr double kTurningSkinMm = 3e-3;
        const Vec3 p = volume.frame().to_patient(volume.point_in_path_mm(disc, i));
        const double distance_mm = test::min_distance_mm(profile, last, pose, p, kFinestMm);
        // Positions of 500 mm carry 1e-13 mm each.
        if (distance_mm < -1e-10) {
          ASSERT_FALSE(volume.is_occupied(disc, i)) << step << " at " << distance_mm;
        } else if (distance_mm > kFinestMm + kTurningSkinMm) {
          ASSERT_TRUE(volume.is_occupied(disc, i)) << step << " at " << distance_mm;
        }
        died += volume.is_occupied(disc, i) ? 0U : 1U;
      }
    }
    ASSERT_EQ(result.removed, died);
    ASSERT_EQ(result.removed_hu, 1000 * static_cast<std::int64_t>(died));
    ASSERT_GE(result.tested, result.removed);
    removed_in_all += died;
    last = pose;
  }
  // The operator did drill.
  EXPECT_GT(removed_in_all, volume.point_count() / 20);
}

INSTANTIATE_TEST_SUITE_P(Seeds, ReferenceEngineMotion, ::testing::Values(1, 2, 3, 4, 5, 6, 7, 8));

SLOW_TESTS("ReferenceEngine.*");

TEST(ReferenceEngine, RemovesNothingWhenTheBitIsOutside) {
  PointVolume volume = block(4.0, 1.0, 0.1);
  const auto engine = make_reference_engine(volume, {1.0, 10.0, 2.0}, {});
  for (int i = 0; i < 100; ++i) {
    // Before the entry, then past the volume's side at 0.05 mm, then behind its end.
    engine->step(pose_at(volume, Vec3(0, 0, -0.05 * (100 - i) - 0.001)));
  }
  EXPECT_EQ(volume.occupied_count(), volume.point_count());
  const auto beside = make_reference_engine(volume, {1.0, 10.0, 2.0}, {});
  for (int i = 0; i < 100; ++i) beside->step(pose_at(volume, Vec3(0, 1.45, 0.1 * i)));
  EXPECT_EQ(volume.occupied_count(), volume.point_count());
}

TEST(ReferenceEngine, SurvivesABitThatIsTurnedRound) {
  // Half way between two opposite axes lies no axis: any half turn will do.
  PointVolume volume = block(4.0, 1.5, 0.1);
  const auto engine = make_reference_engine(volume, {1.0, 2.0, 1.0}, {});
  engine->step(pose_at(volume, Vec3(0, 0, 2.0)));
  engine->step(pose_at(volume, Vec3(0, 0, 2.0), -Vec3::UnitZ()));
  // At the end the bit points back, and has its base at 4 mm.
  EXPECT_FALSE(volume.is_occupied(35, 0));
  EXPECT_FALSE(volume.is_occupied(5, 0));
  // In the tip's plane the bit has passed to one side only, no wider than it is.
  const DiscPattern& pattern = volume.pattern();
  Eigen::Vector2d middle_mm(0, 0);
  for (std::size_t i = 0; i < pattern.point_count(); ++i) {
    if (!volume.is_occupied(20, i)) middle_mm += pattern.point_mm(i);
  }
  ASSERT_GT(middle_mm.norm(), 1.0);
  const Eigen::Vector2d side = middle_mm.normalized();
  for (std::size_t i = 0; i < pattern.point_count(); ++i) {
    const Eigen::Vector2d& p = pattern.point_mm(i);
    const double across_mm = std::abs(p.x() * side.y() - p.y() * side.x());
    const double cone_mm = 0.5 * p.dot(side);
    if (volume.is_occupied(20, i)) {
      EXPECT_FALSE(across_mm < std::min(cone_mm, 0.5) - 0.01) << p.transpose();
    } else {
      EXPECT_TRUE(p.dot(side) > -0.01 && across_mm < 0.51) << p.transpose();
    }
  }
}

/// Work of drilling a homogeneous block from `begin_mm` to `end_mm`, over that way, N.
double work_over_way_n(double spacing_mm, double diameter_mm, double step_mm, const Vec3& offset_mm = Vec3::Zero()) {
  constexpr double kBeginMm = 6.0;
  constexpr double kEndMm = 10.0;
  PointVolume volume = block(12.0, 3.0, spacing_mm);
  const auto engine = make_reference_engine(volume, {diameter_mm, 50.0, 5.0}, {});
  // Not to the depth itself: there discs lie, and rounding would decide about them.
  const double begin_mm = kBeginMm + 0.31 * step_mm;
  engine->step(pose_at(volume, offset_mm + Vec3(0, 0, -0.5 * spacing_mm)));
  engine->step(pose_at(volume, offset_mm + Vec3(0, 0, begin_mm)));
  double work_n_mm = 0.0;
  double removed_mm3 = 0.0;
  const int steps = static_cast<int>(std::lround((kEndMm - kBeginMm) / step_mm));
  for (int i = 1; i <= steps; ++i) {
    const StepResult result = engine->step(pose_at(volume, offset_mm + Vec3(0, 0, begin_mm + step_mm * i)));
    work_n_mm += result.work_n_mm;
    removed_mm3 += result.removed_mm3;
  }
  EXPECT_NEAR(work_n_mm, Material{}.cutting_energy_mpa(1000.0) * removed_mm3, 1e-6 * work_n_mm);
  return work_n_mm / (kEndMm - kBeginMm);
}

double section_mm2(double diameter_mm) { return 0.25 * std::numbers::pi * diameter_mm * diameter_mm; }

TEST(ReferenceEngine, WorksWithPressureTimesSectionInHomogeneousBone) {
  const double pressure_mpa = Material{}.cutting_energy_mpa(1000.0);
  // Rings stand for bone half a spacing to either side. A radius of 1.55 mm ends between rings 15 and 16 of 0.1 mm,
  // where the rings within hold the section exactly.
  EXPECT_NEAR(work_over_way_n(0.1, 3.1, 0.005), pressure_mpa * section_mm2(3.1),
              0.01 * pressure_mpa * section_mm2(3.1));
}

TEST(ReferenceEngine, WorksTheSameWhateverTheStep) {
  const double at_5_um_n = work_over_way_n(0.1, 3.1, 0.005);
  // All cut the same discs; a ring at either end of the way may fall to its other side: 90 of 31,000 points.
  EXPECT_NEAR(work_over_way_n(0.1, 3.1, 0.001), at_5_um_n, 0.003 * at_5_um_n);
  EXPECT_NEAR(work_over_way_n(0.1, 3.1, 0.020), at_5_um_n, 0.003 * at_5_um_n);
}

TEST(ReferenceEngine, WorksNearlyTheSameWhateverTheSpacingBesideThePath) {
  const double expected_n = Material{}.cutting_energy_mpa(1000.0) * section_mm2(3.0);
  for (const double spacing_mm : {0.2, 0.1, 0.05}) {
    const double work_n = work_over_way_n(spacing_mm, 3.0, 0.2, Vec3(0.83, 0.47, 0.0));
    EXPECT_NEAR(work_n, expected_n, 0.02 * expected_n) << spacing_mm;
  }
}

TEST(ReferenceEngine, CutsWholeRingsOnThePath) {
  // On the path the bit's section is cut along a whole ring, so that the section is right to half a spacing of radius
  // and no better. The bit of 3.0 mm ends exactly on ring 15 of 0.1 mm and ring 30 of 0.05 mm, which it takes.
  const double pressure_mpa = Material{}.cutting_energy_mpa(1000.0);
  for (const auto& [spacing_mm, last_ring] : {std::pair(0.2, 7), std::pair(0.1, 15), std::pair(0.05, 30)}) {
    const double cut_mm = (2 * last_ring + 1) * spacing_mm;
    const double expected_n = pressure_mpa * section_mm2(cut_mm);
    EXPECT_NEAR(work_over_way_n(spacing_mm, 3.0, 0.02), expected_n, 0.003 * expected_n) << spacing_mm;
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
        if (!volume.is_occupied(disc, DiscPattern::ring_start(ring) + i)) {
          removed_mm3 += volume.pattern().point_volume_mm3(ring);
        }
      }
    }
  }
  // The tip is at 12.05 mm; the first disc stands for bone from -0.05 mm on. The cone is a third of its cylinder.
  const double expected_mm3 = section_mm2(3.1) * (12.1 - 5.0 + 5.0 / 3.0);
  EXPECT_NEAR(removed_mm3, expected_mm3, 0.003 * expected_mm3);
}

TEST(ReferenceEngine, DoesNoWorkWhereNothingIsOccupied) {
  PointVolume volume = block(4.0, 1.5, 0.1);
  const auto engine = make_reference_engine(volume, {1.5, 10.0, 2.0}, {});
  engine->step(pose_at(volume, Vec3(0, 0, 2.0)));
  const StepResult again = engine->step(pose_at(volume, Vec3(0, 0, 2.0)));
  EXPECT_EQ(again.removed, 0U);
  EXPECT_EQ(again.work_n_mm, 0.0);
  const StepResult back = engine->step(pose_at(volume, Vec3(0.3, 0, 1.5)));
  EXPECT_GT(back.removed, 0U);
  EXPECT_GT(back.work_n_mm, 0.0);
}

}  // namespace
}  // namespace spinaltap
