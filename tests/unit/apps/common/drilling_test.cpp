#include "apps/common/drilling.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "core/base/error.h"
#include "mesh/mesh_quality.h"
#include "tests/support/analytic_bodies.h"
#include "vdb/isosurface.h"

namespace spinaltap {
namespace {

using test::Ball;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr std::int16_t kHu = 300;
const Ball kBall{Vec3(3.1, -2.3, 105.7), 15.0};

const BoneModel& ball_bone() {
  static const BoneModel bone = test::bake_ball(kBall, 0.25, kHu);
  return bone;
}

/// From the surface 22 mm along a slanting diameter. The bit's wall lies between two rings of points, where their
/// shares of the section add up to it exactly; at 3.0 mm it would lie on one.
DrillPath diameter_path() {
  const Vec3 axis = Vec3(0.2, -0.9, 0.3).normalized();
  const Vec3 entry = kBall.centre_mm - kBall.radius_mm * axis;
  return {"diameter", entry, entry + 22.0 * axis, {3.1, 50.0, 5.0}};
}

DrillingOptions quick() {
  DrillingOptions options;
  options.motion.step_mm = 0.02;
  options.log_step_mm = 0.5;
  return options;
}

const Drilling& drilled_ball() {
  static const Drilling drilling = drill_bone(ball_bone(), diameter_path(), {}, quick());
  return drilling;
}

TEST(DrillBone, NeedsTheMaterialsPressureTimesTheSection) {
  const Material material;
  const double section_mm2 = std::numbers::pi * std::pow(diameter_path().bit.radius_mm(), 2);
  const double expected_n = material.pressure_mpa(kHu) * section_mm2;
  int rows = 0;
  for (const DepthRow& row : drilled_ball().rows) {
    // From where the whole cone is in; the surface is curved.
    if (row.depth_mm < 6.5) continue;
    ++rows;
    // A row of 0.5 mm holds 5 discs of points, whose edges it may cut: 1% of a disc of a row.
    EXPECT_NEAR(row.thrust_n, expected_n, 0.01 * expected_n) << row.depth_mm;
    EXPECT_NEAR(row.hu, kHu, 1e-9);
    EXPECT_NEAR(row.density_g_cm3, material.density.density_g_cm3(kHu), 1e-12);
  }
  EXPECT_EQ(rows, 32);
  EXPECT_NEAR(drilled_ball().most_thrust_n, expected_n, 0.01 * expected_n);
}

TEST(DrillBone, NeedsNoForceBeforeItMeetsBoneAndLessWithTheConesTip) {
  const Material material;
  const DrillPath path = diameter_path();
  const double whole_n = material.pressure_mpa(kHu) * std::numbers::pi * std::pow(path.bit.radius_mm(), 2);
  for (const DepthRow& row : drilled_ball().rows) {
    if (row.depth_mm < -0.05) {
      EXPECT_EQ(row.removed, 0U);
      EXPECT_EQ(row.thrust_n, 0.0);
      EXPECT_TRUE(std::isnan(row.hu));
      EXPECT_TRUE(std::isnan(row.density_g_cm3));
    } else if (row.depth_mm > 1.5 && row.depth_mm < 4.6) {
      // Thrust is the pressure on the cone's section at the surface, where the row's depths average d² (nearly flat).
      const double share = std::pow((row.depth_mm - 0.25) / path.bit.tip_length_mm, 2);
      EXPECT_NEAR(row.thrust_n, share * whole_n, 0.12 * whole_n) << row.depth_mm;
    }
  }
  EXPECT_NEAR(drilled_ball().entry_depth_mm, 0.0, 0.15);
}

TEST(DrillBone, DoesTheWorkOfTheVolumeItRemoves) {
  // The hole: a cylinder from the entry to the shoulder, and the cone, less the cap that the sphere leaves out.
  const DrillPath path = diameter_path();
  const double r = path.bit.radius_mm();
  const double cap_height = kBall.radius_mm - std::sqrt(kBall.radius_mm * kBall.radius_mm - r * r);
  const double missing_mm3 = std::numbers::pi * r * r * cap_height / 2.0;
  const double hole_mm3 = std::numbers::pi * r * r * (22.0 - path.bit.tip_length_mm * 2.0 / 3.0) - missing_mm3;
  double work_n_mm = 0.0;
  double begin_mm = -3.0;
  std::size_t removed = 0;
  for (const DepthRow& row : drilled_ball().rows) {
    work_n_mm += row.thrust_n * (row.depth_mm - begin_mm);
    begin_mm = row.depth_mm;
    removed += row.removed;
  }
  EXPECT_EQ(removed, drilled_ball().removed);
  // Points a tenth of a millimetre apart; the cone's wall cuts their cells at random.
  EXPECT_NEAR(work_n_mm, Material().pressure_mpa(kHu) * hole_mm3, 0.01 * Material().pressure_mpa(kHu) * hole_mm3);
  const double taken_mm3 = measure_mesh(bone_surface(ball_bone())).volume_mm3 -
                           measure_mesh(bone_surface(drilled_ball().drilled)).volume_mm3;
  EXPECT_NEAR(taken_mm3, hole_mm3, 0.01 * hole_mm3);
}

TEST(DrillBone, CountsWhatTheVolumeHolds) {
  const Drilling& drilling = drilled_ball();
  EXPECT_EQ(drilling.points_per_disc, 2611U);
  EXPECT_EQ(drilling.discs, 250);
  EXPECT_EQ(drilling.points, 250U * 2611U);
  EXPECT_EQ(drilling.cycles, 1250U);
  EXPECT_LT(drilling.removed, drilling.points_in_bone);
  std::size_t cycles = 0;
  for (const DepthRow& row : drilling.rows) cycles += row.cycles;
  EXPECT_EQ(cycles, drilling.cycles);
  EXPECT_EQ(drilling.rows.size(), 50U);
  EXPECT_NEAR(drilling.rows.back().depth_mm, 22.0, 1e-9);
}

TEST(DrillBone, RemovesTheSameAtAnyAdvance) {
  DrillingOptions slower = quick();
  slower.motion.step_mm = 0.007;
  const Drilling drilling = drill_bone(ball_bone(), diameter_path(), {}, slower);
  EXPECT_EQ(drilling.removed, drilled_ball().removed);
  EXPECT_EQ(drilling.rows.size(), drilled_ball().rows.size());
}

TEST(DrillBone, RemovesTheSameWithEveryEngine) {
  DrillingOptions tilted = quick();
  tilted.volume.spacing_mm = 0.2;
  tilted.motion.tilt_deg = 2.0;
  const Drilling ring = drill_bone(ball_bone(), diameter_path(), {}, tilted);
  EXPECT_GT(ring.removed, 10'000U);
  for (const EngineKind kind : {EngineKind::leaf, EngineKind::arc, EngineKind::reference}) {
    tilted.engine = kind;
    const Drilling other = drill_bone(ball_bone(), diameter_path(), {}, tilted);
    EXPECT_EQ(other.removed, ring.removed);
    EXPECT_EQ(other.most_thrust_n, ring.most_thrust_n);
  }
}

TEST(DrillBone, CutsTheSameBoneWithFinerPointsNearTheSurface) {
  const auto work_n_mm = [](const Drilling& drilling) {
    double sum = 0.0;
    double before_mm = -quick().volume.lead_in_mm;
    for (const DepthRow& row : drilling.rows) {
      sum += row.thrust_n * (row.depth_mm - before_mm);
      before_mm = row.depth_mm;
    }
    return sum;
  };
  DrillingOptions coarse = quick();
  coarse.volume.spacing_mm = 0.2;
  DrillingOptions fine = coarse;
  fine.fine_spacing_mm = 0.1;
  fine.fine_near_mm = 3.0;
  fine.fine_tip_mm = 2.0;
  const Drilling by_coarse = drill_bone(ball_bone(), diameter_path(), {}, coarse);
  const Drilling by_fine = drill_bone(ball_bone(), diameter_path(), {}, fine);
  ASSERT_EQ(by_fine.volumes.size(), 3U);  // around the entry, between, before the target
  EXPECT_GT(by_fine.points, by_coarse.points * 2);
  // A bit of 15.5 spacings across is cut to 1 % at 0.2 mm, and better at 0.1 mm.
  EXPECT_NEAR(work_n_mm(by_fine), work_n_mm(by_coarse), 0.02 * work_n_mm(by_coarse));
}

TEST(DrillBone, AsksTheExactSurfaceWhereThereIsOne) {
  class SmallerBall final : public ScalarField {
   public:
    void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3>) const override {
      for (std::size_t i = 0; i < points_mm.size(); ++i) {
        values_mm[i] = (points_mm[i] - kBall.centre_mm).norm() - (kBall.radius_mm - 5.0);
      }
    }
  };
  const SmallerBall exact;
  DrillingOptions options = quick();
  options.exact = &exact;
  const Drilling drilling = drill_bone(ball_bone(), diameter_path(), {}, options);
  // The tip meets the smaller ball 5 mm beyond the entry; the first disc in it may lie a spacing further.
  EXPECT_NEAR(drilling.entry_depth_mm, 5.0, 0.15);
  // A cylinder of 3 mm, less half a spacing, from 5 mm to 22 mm, in points of their share of the section.
  const double expected = std::numbers::pi * 2.95 * 2.95 * 17.0 / (std::numbers::pi / 3.0 * 1e-3);
  EXPECT_NEAR(static_cast<double>(drilling.points_in_bone), expected, 0.03 * expected);
}

TEST(DrillBone, TakesOneByteLessAPointWithCtNumbersOfEightBits) {
  DrillingOptions options = quick();
  options.volume.hu_bits = HuBits::eight;
  const Drilling drilling = drill_bone(ball_bone(), diameter_path(), {}, options);
  EXPECT_EQ(drilling.removed, drilled_ball().removed);
  EXPECT_NEAR(drilled_ball().bytes_per_point - drilling.bytes_per_point, 1.0, 0.01);
}

TEST(DrillBone, SaysWhereAPathRunsThatMissesTheBone) {
  DrillPath path = diameter_path();
  path.name = "beside";
  path.entry_mm = Vec3(60.5, -2.0, 100.0);
  path.target_mm = Vec3(60.5, 20.25, 100.0);
  EXPECT_THAT(
      [&] { drill_bone(ball_bone(), path, {}, quick()); },
      ThrowsMessage<Error>(AllOf(HasSubstr("\"beside\""), HasSubstr("misses the bone"), HasSubstr("60.5, -2, 100"),
                                 HasSubstr("60.5, 20.25, 100"), HasSubstr("the bone lies within (-12."))));
}

TEST(DrillBone, RefusesALogStepThatIsNotAboveZero) {
  for (const double step_mm : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    DrillingOptions options = quick();
    options.log_step_mm = step_mm;
    EXPECT_THROW(drill_bone(ball_bone(), diameter_path(), {}, options), Error);
  }
}

TEST(DrillLog, HasUnitsInItsHeadAndEmptyFieldsWhereNothingIsKnown) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const DepthRow nothing{-2.9, 100, 0, 0, kNan, kNan, 0.0, 1e6};
  const DepthRow bone{0.1, 100, 12, 340, 300.5, 0.365, 1.25, 250000.0};
  EXPECT_EQ(log_csv({nothing, bone}),
            "depth_mm,cycles,removed_points,tested_points,mean_hu,density_g_cm3,thrust_N,cycles_per_s\n"
            "-2.9,100,0,0,,,0,1000000\n"
            "0.1,100,12,340,300.5,0.365,1.25,250000\n");
}

TEST(DrillLog, OfADrillingHasEightColumnsInEveryRow) {
  std::istringstream csv(log_csv(drilled_ball().rows));
  std::string line;
  std::size_t lines = 0;
  while (std::getline(csv, line)) {
    ++lines;
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 7) << line;
    EXPECT_EQ(line.find("nan"), std::string::npos) << line;
  }
  EXPECT_EQ(lines, drilled_ball().rows.size() + 1);
}

}  // namespace
}  // namespace spinaltap
