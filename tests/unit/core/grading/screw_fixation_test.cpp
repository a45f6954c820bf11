#include "core/grading/screw_fixation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/base/error.h"
#include "tests/support/foam_fixation_model.h"
#include "tests/support/nan.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kFixationPi = std::numbers::pi;

/// Density by a formula of the place.
DensitySampler density_by(const std::function<double(const Vec3&)>& g_cm3) {
  return [g_cm3](std::span<const Vec3> places_mm, std::span<double> found) {
    for (std::size_t n = 0; n < found.size(); ++n) found[n] = g_cm3(places_mm[n]);
  };
}
DensitySampler even_bone(double g_cm3) {
  return density_by([g_cm3](const Vec3&) { return g_cm3; });
}

/// 6.5 x 45 mm, core of 4.5 mm, pitch of 2.5 mm, flanks at right angles to the axis; 45 mm along an odd direction.
DrillPath screwed_path(double hole_mm = 3.0) {
  const Vec3 entry_mm(3.0, -7.0, 11.0);
  DrillPath path{"left", entry_mm, entry_mm + 45.0 * Vec3(1.0, -2.0, 0.5).normalized(), {hole_mm, 50.0, 1.0}};
  path.screw = PedicleScrew{"", 6.5, 45.0, 5.0};
  path.screw->thread = ScrewThread{.core_diameter_mm = 4.5, .pitch_mm = 2.5, .crest_mm = 0.25, .flank_deg = 0.0};
  return path;
}

TEST(ScrewFixation, OfEvenBoneIsChapmansFormula) {
  const double g_cm3 = 0.2;
  const ScrewFixation fixation = screw_fixation(screwed_path(), even_bone(g_cm3));
  // F = S L pi D (0.5 + 0.57735 d / p): by hand, 40 mm of thread behind a cone of 5 mm.
  const double shear_mpa = 51.6 * std::pow(g_cm3 / 1.9, 1.7);
  EXPECT_NEAR(fixation.pullout_n.median, shear_mpa * 40.0 * kFixationPi * 6.5 * (0.5 + 0.57735 * 1.0 / 2.5), 1e-6);
  EXPECT_NEAR(fixation.engaged_mm, 40.0, 1e-9);
  EXPECT_DOUBLE_EQ(fixation.cortical_share, 0.0);
  for (const FixationRow& row : fixation.rows) EXPECT_NEAR(row.shear_mpa, shear_mpa, 1e-9);
}

TEST(ScrewFixation, TorqueOfEvenBoneGrowsEvenlyToFrictionOnAllThreadAndTheWorkOfATurn) {
  const double g_cm3 = 0.2;
  const ScrewFixation fixation = screw_fixation(screwed_path(), even_bone(g_cm3));
  const double pressure_mpa = 117.3 * std::pow(g_cm3 / 1.9, 1.7);
  // Both flanks of a turn, integral of r 2 pi r dr, each 2.5 mm; the core between threads, 2.25 of each 2.5 mm.
  const double flanks_mm2 = 2.0 * 2.0 * kFixationPi / 3.0 * (std::pow(3.25, 3) - std::pow(2.25, 3)) / 2.5;
  const double core_mm2 = 2.0 * kFixationPi * 2.25 * 2.25 * 0.9;
  const double rubbing_n = 0.3 * pressure_mpa * (flanks_mm2 + core_mm2);
  // A turn displaces the thread's section (1 mm by 0.25 mm) round its middle (2.75 mm) and the core beyond the hole.
  const double displaced_mm3 = 0.25 * 2.0 * kFixationPi * 2.75 + kFixationPi * (2.25 * 2.25 - 1.5 * 1.5) * 2.5;
  const double forming_n_mm = pressure_mpa * displaced_mm3 / (2.0 * kFixationPi);
  EXPECT_NEAR(fixation.max_torque_n_mm.median, rubbing_n * 40.0 + forming_n_mm, 1e-6);
  ASSERT_EQ(fixation.rows.size(), 91u);
  for (const FixationRow& row : fixation.rows) {
    const double thread_mm = std::max(0.0, row.depth_mm - 5.0), cone_mm = std::min(row.depth_mm, 5.0);
    EXPECT_NEAR(row.torque_n_mm, rubbing_n * thread_mm + forming_n_mm * cone_mm / 5.0, 1e-6) << row.depth_mm;
  }
}

TEST(ScrewFixation, StiffnessOfEvenBoneIsThatOfAPileInShear) {
  // Randolph & Wroth 1978: 2 pi L G / ln(2.5 L (1 - nu) / r), G of 4,730 MPa at 1 g/cm3 and a Poisson's ratio of 0.3.
  const ScrewFixation fixation = screw_fixation(screwed_path(), even_bone(0.3));
  const double shear_modulus_mpa = 4730.0 * std::pow(0.3, 1.56) / 2.6;
  EXPECT_NEAR(fixation.stiffness_n_mm.median,
              2.0 * kFixationPi * 40.0 * shear_modulus_mpa / std::log(2.5 * 40.0 * 0.7 / 3.25), 1e-6);
}

TEST(ScrewFixation, OfBoneInLayersIsTheSumOfItsLayers) {
  // Cortex of 1.5 g/cm3 for 10 mm, cancellous bone of 0.2 g/cm3 behind it; none from 30 mm on.
  const DrillPath path = screwed_path();
  const auto layer = [&](double depth_mm) { return depth_mm < 10.0 ? 1.5 : depth_mm < 30.0 ? 0.2 : 0.0; };
  const ScrewFixation fixation = screw_fixation(
      path, density_by([&](const Vec3& p_mm) { return layer((p_mm - path.entry_mm).dot(path.direction())); }));
  const double area_mm = kFixationPi * 6.5 * (0.5 + 0.57735 * 1.0 / 2.5);
  const double cortex_n = 10.0 * area_mm * 51.6 * std::pow(1.5 / 1.9, 1.7);
  const double cancellous_n = 20.0 * area_mm * 51.6 * std::pow(0.2 / 1.9, 1.7);
  EXPECT_NEAR(fixation.pullout_n.median, cortex_n + cancellous_n, 1e-6);
  EXPECT_NEAR(fixation.cortical_share, cortex_n / (cortex_n + cancellous_n), 1e-9);
  EXPECT_NEAR(fixation.engaged_mm, 30.0, 1e-9);
}

TEST(ScrewFixation, OfAThreadHalfOutOfBoneIsHalf) {
  const DrillPath path = screwed_path();
  const Vec3 side = any_perpendicular(path.direction());
  const double half_n =
      screw_fixation(path,
                     density_by([&](const Vec3& p_mm) { return (p_mm - path.entry_mm).dot(side) > 1e-6 ? 0.25 : 0.0; }))
          .pullout_n.median;
  // Two of 24 places around lie on the border.
  EXPECT_NEAR(half_n / screw_fixation(path, even_bone(0.25)).pullout_n.median, 0.5, 1.0 / 24.0 + 1e-9);
}

TEST(ScrewFixation, AHoleWiderThanTheCoreLeavesLessThreadInBoneAndNoPressureOnTheCore) {
  const double narrow_n = screw_fixation(screwed_path(4.5), even_bone(0.2)).pullout_n.median;
  // 0.5 mm of thread in bone instead of 1 mm.
  const ScrewFixation wide = screw_fixation(screwed_path(5.5), even_bone(0.2));
  EXPECT_NEAR(wide.pullout_n.median / narrow_n, (0.5 + 0.57735 * 0.5 / 2.5) / (0.5 + 0.57735 * 1.0 / 2.5), 1e-12);
  const double pressure_mpa = 117.3 * std::pow(0.2 / 1.9, 1.7);
  const double flanks_mm2 = 2.0 * 2.0 * kFixationPi / 3.0 * (std::pow(3.25, 3) - std::pow(2.75, 3)) / 2.5;
  const double thread_mm3 = 0.5 * 0.25 * 2.0 * kFixationPi * 3.0;
  EXPECT_NEAR(wide.max_torque_n_mm.median, pressure_mpa * (0.3 * flanks_mm2 * 40.0 + thread_mm3 / (2.0 * kFixationPi)),
              1e-6);
  // A hole as wide as the screw holds nothing.
  const ScrewFixation loose = screw_fixation(screwed_path(6.5), even_bone(0.2));
  EXPECT_EQ(loose.pullout_n.median, 0.0);
  EXPECT_EQ(loose.max_torque_n_mm.median, 0.0);
  EXPECT_EQ(loose.engaged_mm, 0.0);
  EXPECT_EQ(loose.stiffness_n_mm.median, 0.0);
}

TEST(ScrewFixation, OfAConicalCoreIsTheIntegralOverItsDepths) {
  DrillPath path = screwed_path();
  path.screw->thread->tip_core_diameter_mm = 3.5;
  // The mean depth of thread is (1 + 1.5) / 2 mm, and the shape factor goes with it linearly.
  const double shear_mpa = 51.6 * std::pow(0.2 / 1.9, 1.7);
  EXPECT_NEAR(screw_fixation(path, even_bone(0.2)).pullout_n.median,
              shear_mpa * 40.0 * kFixationPi * 6.5 * (0.5 + 0.57735 * 1.25 / 2.5), 1e-6);
  // It presses its way: more torque than a thin core all along, less than a thick one.
  const double conical_n_mm = screw_fixation(path, even_bone(0.2)).max_torque_n_mm.median;
  EXPECT_LT(conical_n_mm, screw_fixation(screwed_path(), even_bone(0.2)).max_torque_n_mm.median);
  path.screw->thread->core_diameter_mm = 3.5;
  EXPECT_GT(conical_n_mm, screw_fixation(path, even_bone(0.2)).max_torque_n_mm.median);
}

TEST(ScrewFixation, BandsAreThoseOfTheSpreadsAlone) {
  FixationModel sure;
  sure.density_spread = sure.strength_spread = sure.modulus_spread = sure.friction_spread = sure.model_spread = 0.0;
  const ScrewFixation known = screw_fixation(screwed_path(), even_bone(0.2), sure);
  EXPECT_EQ(known.pullout_n.p05, known.pullout_n.median);
  EXPECT_EQ(known.pullout_n.p95, known.pullout_n.median);
  const ScrewFixation fixation = screw_fixation(screwed_path(), even_bone(0.2));
  EXPECT_EQ(fixation.pullout_n.median, known.pullout_n.median);
  // 1.645 standard deviations of the logarithm: 10 % of the density to the power of 1.7, 35 % and 10 %.
  const double spread = std::sqrt(0.17 * 0.17 + 0.35 * 0.35 + 0.1 * 0.1);
  EXPECT_NEAR(std::log(fixation.pullout_n.p95 / fixation.pullout_n.median), 1.6449 * spread, 1e-4);
  EXPECT_NEAR(std::log(fixation.pullout_n.median / fixation.pullout_n.p05), 1.6449 * spread, 1e-4);
  EXPECT_GT(fixation.max_torque_n_mm.p95 / fixation.max_torque_n_mm.median,
            fixation.pullout_n.p95 / fixation.pullout_n.median);
}

TEST(ScrewFixation, FoamsStrengthIsThatOfItsDataSheet) {
  const FixationModel foam = test::foam_fixation_model();
  // Solid rigid polyurethane foam of ASTM F1839, by grade: shear and compressive strength, MPa. The law goes through
  // 10 and 20 pcf; the others are off it by 8 % at most.
  struct Sheet {
    double g_cm3, shear_mpa, crushing_mpa;
  };
  for (const Sheet& sheet : {Sheet{0.08, 0.59, 0.60}, Sheet{0.16, 1.6, 2.2}, Sheet{0.24, 2.8, 4.9},
                             Sheet{0.32, 4.3, 8.4}, Sheet{0.48, 7.6, 18.0}, Sheet{0.64, 11.0, 31.0}}) {
    EXPECT_NEAR(foam.shear.mpa(sheet.g_cm3) / sheet.shear_mpa, 1.0, 0.08) << sheet.g_cm3;
    EXPECT_NEAR(foam.crushing.mpa(sheet.g_cm3) / sheet.crushing_mpa, 1.0, 0.08) << sheet.g_cm3;
  }
}

TEST(ScrewFixation, BonesStrengthIsWhatVertebraeAndCortexHave) {
  const FixationModel bone;
  // Human cortex crosswise bears some 130 MPa (Reilly & Burstein 1975), vertebral cancellous bone of 0.17 g/cm3 yields
  // under 1.92 +- 0.84 MPa (Kopperdahl & Keaveny 1998): neither made the law.
  EXPECT_NEAR(bone.crushing.mpa(1.9), 131.0, 0.15 * 131.0);
  EXPECT_NEAR(bone.crushing.mpa(0.17), 1.92, 0.84);
  EXPECT_NEAR(bone.shear.mpa(0.17) / bone.crushing.mpa(0.17), 0.44, 0.001);
  EXPECT_EQ(bone.shear.mpa(0.0), 0.0);
  EXPECT_EQ(bone.shear.mpa(-1.0), 0.0);
}

TEST(ScrewFixation, IsRejectedWhereItMakesNoSense) {
  DrillPath path = screwed_path();
  EXPECT_THAT([&] { screw_fixation(path, {}); }, ThrowsMessage<Error>(HasSubstr("sampler")));
  path.screw.reset();
  EXPECT_THAT([&] { screw_fixation(path, even_bone(0.2)); }, ThrowsMessage<Error>(HasSubstr("expected a screw")));
  FixationModel model;
  model.friction = test::kNan;
  EXPECT_THAT([&] { screw_fixation(screwed_path(), even_bone(0.2), model); },
              ThrowsMessage<Error>(HasSubstr("friction")));
  model = {};
  model.shear.at_reference_mpa = 0.0;
  EXPECT_THAT([&] { check_fixation_model(model); }, ThrowsMessage<Error>(HasSubstr("strength")));
  model = {};
  model.strength_spread = -0.1;
  EXPECT_THAT([&] { check_fixation_model(model); }, ThrowsMessage<Error>(HasSubstr("spread")));
}

}  // namespace
}  // namespace spinaltap
