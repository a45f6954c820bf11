#include "core/registration/register_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/base/error.h"
#include "core/base/random.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/nan.h"
#include "tests/support/planning_bones.h"

namespace spinaltap {
namespace {

// An ellipsoid with a knob: no turn or shift of it is like itself.
double knobbed_mm(const Vec3& p) {
  const Vec3 radii(16.0, 11.0, 8.0);
  const Vec3 scaled = p.cwiseQuotient(radii);
  const double egg = (scaled.norm() - 1.0) * scaled.norm() / std::max(1e-9, scaled.cwiseQuotient(radii).norm());
  const double knob = (p - Vec3(9.0, 9.0, 5.0)).norm() - 4.0;
  return std::min(egg, knob);
}

const test::FormulaBone& knobbed_bone() {
  static const test::FormulaBone bone(knobbed_mm, Box3(Vec3::Constant(-20.0), Vec3::Constant(20.0)), 0.0, 10.0);
  return bone;
}

/// Places of its surface with noise, as measured in another frame.
std::vector<Vec3> touched(const BoneShape& bone, std::size_t count, double noise_mm, const RigidPose& ct_from_patient,
                          std::uint64_t seed) {
  std::vector<Vec3> points;
  for (std::size_t n = 0; n < count; ++n) {
    const auto at =
        static_cast<std::size_t>(random_uniform(seed, 8 * n) * static_cast<double>(bone.points_mm().size()));
    Vec3 noise;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      noise[static_cast<Eigen::Index>(axis)] = noise_mm * random_normal(seed, 8 * n + 1 + axis);
    }
    points.push_back(ct_from_patient.inverse().apply(bone.points_mm()[at] + noise));
  }
  return points;
}

RigidPose known() { return small_motion(Vec3(0.2, -0.1, 0.25), Vec3(6.0, -8.0, 5.0), Vec3::Zero()); }

TEST(RegisterSurface, FindsAKnownPoseFromFarOff) {
  const BoneShape& bone = knobbed_bone().bone();
  const Registration found = register_surface(bone, touched(bone, 60, 0.0, known(), 1));
  // The samples themselves lie on the surface to a few microns.
  EXPECT_LT((found.ct_from_patient.apply(Vec3::Zero()) - known().apply(Vec3::Zero())).norm(), 0.02);
  EXPECT_LT(angle_between_rad(found.ct_from_patient, known()), 0.002);
  EXPECT_TRUE(found.warnings.empty()) << found.warnings.front();
}

TEST(RegisterSurface, LeavesOutPointsThatMissTheBone) {
  const BoneShape& bone = knobbed_bone().bone();
  std::vector<Vec3> points = touched(bone, 60, 0.1, known(), 2);
  for (const std::size_t n : {std::size_t{7}, std::size_t{20}, std::size_t{41}}) points[n] += Vec3(0.0, 0.0, 6.0);
  const Registration found = register_surface(bone, points, {.noise_mm = 0.1});
  EXPECT_EQ(found.rejected, (std::vector<std::size_t>{7, 20, 41}));
  EXPECT_LT((found.ct_from_patient.apply(Vec3::Zero()) - known().apply(Vec3::Zero())).norm(), 0.1);
}

TEST(RegisterSurface, IsTheSameBitForBit) {
  const BoneShape& bone = knobbed_bone().bone();
  const std::vector<Vec3> points = touched(bone, 40, 0.2, known(), 3);
  const Registration a = register_surface(bone, points), b = register_surface(bone, points);
  EXPECT_EQ(a.ct_from_patient.rotation, b.ct_from_patient.rotation);
  EXPECT_EQ(a.ct_from_patient.translation_mm, b.ct_from_patient.translation_mm);
  EXPECT_EQ(a.covariance.turn_rad2, b.covariance.turn_rad2);
}

// A flat face holds three motions of six.
TEST(RegisterSurface, SaysWhichWayPointsOfAFlatFaceMaySlide) {
  const test::Block block;
  std::vector<Vec3> points;
  for (std::size_t n = 0; n < 40; ++n) {
    points.emplace_back(-25.0 + 50.0 * random_uniform(4, 2 * n), 20.0, -15.0 + 30.0 * random_uniform(4, 2 * n + 1));
  }
  const Registration found = register_surface(block.bone(), points, {.starts = 1, .noise_mm = 0.2});
  std::string all;
  for (const std::string& warning : found.warnings) all += warning + "\n";
  EXPECT_NE(all.find("mostly right to left"), std::string::npos) << all;
  EXPECT_NE(all.find("mostly foot to head"), std::string::npos) << all;
  EXPECT_NE(all.find("may slide"), std::string::npos) << all;
  // Across the face it is held: 0.2 mm of 40 points.
  EXPECT_NEAR(target_error_along_mm(found.covariance, found.covariance.centre_mm, Vec3::UnitY()), 0.2 / std::sqrt(40.0),
              0.005);
}

TEST(RegisterSurface, SaysThatPointsDoNotFit) {
  const BoneShape& bone = knobbed_bone().bone();
  const std::vector<Vec3> points = touched(bone, 60, 1.5, known(), 5);
  const Registration found = register_surface(bone, points, {.noise_mm = 0.2});
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_NE(found.warnings[0].find("scatter by"), std::string::npos) << found.warnings[0];
}

TEST(RegisterSurface, RejectsWhatMakesNoSense) {
  const BoneShape& bone = knobbed_bone().bone();
  std::vector<Vec3> points = touched(bone, 40, 0.1, known(), 6);
  EXPECT_THROW(register_surface(bone, std::span(points).first(11)), Error);
  EXPECT_THROW(register_surface(bone, points, {.noise_mm = test::kNan}), Error);
  EXPECT_THROW(register_surface(bone, points, {.starts = 0}), Error);
  points[5].y() = test::kNan;
  EXPECT_THROW(register_surface(bone, points), Error);
  const std::vector<Vec3> one(40, Vec3(1.0, 2.0, 3.0));
  EXPECT_THROW(register_surface(bone, one), Error);
}

TEST(WeakMotions, AreNoneOfATightPoseAndKeepTheirSigns) {
  PoseCovariance covariance;
  covariance.shift_mm2 = Vec3(0.01, 4.41, 0.01).asDiagonal();
  const std::vector<WeakMotion> motions = weak_motions(covariance, 20.0, 1.0);
  ASSERT_EQ(motions.size(), 1U);
  EXPECT_EQ(in_words(motions[0]), "may slide 2.1 mm along (0.00, 1.00, 0.00), mostly front to back");
  EXPECT_TRUE(weak_motions(covariance, 20.0, 3.0).empty());
}

}  // namespace
}  // namespace spinaltap
