#include "core/registration/register_fiducials.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/base/random.h"
#include "tests/support/nan.h"

namespace spinaltap {
namespace {

const std::vector<Vec3> kMarks{{0, 0, 0}, {60, 5, 0}, {10, 50, 8}, {-30, 20, 40}, {25, -30, 30}};

RigidPose known_pose() { return small_motion(Vec3(0.4, -1.1, 2.0), Vec3(120, -40, 310), Vec3(3, 4, 5)); }

std::vector<Vec3> as_measured(const std::vector<Vec3>& ct_mm, double fle_mm, std::uint64_t seed) {
  std::vector<Vec3> patient;
  std::uint64_t n = 0;
  for (const Vec3& p_mm : ct_mm) {
    Vec3 noise;
    for (int axis = 0; axis < 3; ++axis) noise[axis] = fle_mm / std::sqrt(3.0) * random_normal(seed, n++);
    patient.push_back(known_pose().inverse().apply(p_mm + noise));
  }
  return patient;
}

TEST(RegisterFiducials, GivesBackAKnownPoseExactly) {
  const Registration found = register_fiducials(kMarks, as_measured(kMarks, 0.0, 1));
  EXPECT_LT(angle_between_rad(found.ct_from_patient, known_pose()), 1e-7);
  EXPECT_LT((found.ct_from_patient.translation_mm - known_pose().translation_mm).norm(), 1e-6);
  EXPECT_LT(found.residual_rms_mm, 1e-9);
}

TEST(RegisterFiducials, IsNeverAReflectionOfMarksInAPlane) {
  const std::vector<Vec3> flat{{0, 0, 0}, {60, 0, 0}, {0, 50, 0}, {60, 50, 0}};
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Registration found = register_fiducials(flat, as_measured(flat, 2.0, seed));
    EXPECT_NEAR(found.ct_from_patient.rotation.determinant(), 1.0, 1e-12);
    EXPECT_LT(angle_between_rad(found.ct_from_patient, known_pose()), 0.2);
  }
}

// Fitzpatrick, West & Maurer 1998: TRE² = FLE²/N (1 + 1/3 sum of d_k²/f_k²), with d the target's and f the marks' root
// mean square distance from each principal axis; written out here for marks whose axes are the frame's.
TEST(RegisterFiducials, HasTheTargetErrorOfFitzpatricksFormula) {
  const std::vector<Vec3> cross{{40, 0, 0}, {-40, 0, 0}, {0, 30, 0}, {0, -30, 0}, {0, 0, 20}, {0, 0, -20}};
  const double fle_mm = 0.6;
  const Registration found = register_fiducials(cross, as_measured(cross, 0.0, 1), {.fle_mm = fle_mm});
  for (const Vec3& target : {Vec3(0, 0, 0), Vec3(10, 70, -20), Vec3(100, 0, 0)}) {
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      double f2 = 0.0;
      for (const Vec3& p : cross) f2 += (p.squaredNorm() - p[axis] * p[axis]) / 6.0;
      sum += (target.squaredNorm() - target[axis] * target[axis]) / f2;
    }
    EXPECT_NEAR(target_error_mm(found.covariance, target), fle_mm * std::sqrt((1.0 + sum / 3.0) / 6.0), 1e-9);
  }
}

TEST(RegisterFiducials, PredictWhat2000TrialsGiveByPlaceAndDirection) {
  constexpr int kTrials = 2000;
  const double fle_mm = 0.8;
  const Vec3 target(20, 90, -15);
  Vec3 squares = Vec3::Zero();
  double fre2 = 0.0, fle2 = 0.0;
  for (int n = 0; n < kTrials; ++n) {
    const Registration found = register_fiducials(kMarks, as_measured(kMarks, fle_mm, static_cast<std::uint64_t>(n)));
    const Vec3 error = found.ct_from_patient.apply(known_pose().inverse().apply(target)) - target;
    squares += error.cwiseAbs2() / kTrials;
    fre2 += found.residual_rms_mm * found.residual_rms_mm / kTrials;
    fle2 += 3.0 * found.noise_mm * found.noise_mm / kTrials;
  }
  // A mean of 2,000 squares of normal numbers scatters by 3 %; 4 times half of that for its root.
  EXPECT_NEAR(std::sqrt(fre2), fle_mm * std::sqrt(1.0 - 2.0 / 5.0), 0.03);
  EXPECT_NEAR(std::sqrt(fle2), fle_mm, 0.04);
  const Registration told = register_fiducials(kMarks, as_measured(kMarks, 0.0, 1), {.fle_mm = fle_mm});
  EXPECT_NEAR(target_error_mm(told.covariance, target) / std::sqrt(squares.sum()), 1.0, 0.07);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(target_error_along_mm(told.covariance, target, Vec3::Unit(axis)) / std::sqrt(squares[axis]), 1.0, 0.07);
  }
}

TEST(RegisterFiducials, NamesTheMarkThatMoved) {
  std::vector<Vec3> patient = as_measured(kMarks, 0.3, 7);
  patient[3] += Vec3(0, 0, 12);
  const Registration found = register_fiducials(kMarks, patient, {.fle_mm = 0.5});
  ASSERT_GE(found.warnings.size(), 2U);
  EXPECT_NE(found.warnings[0].find("mm only"), std::string::npos);
  EXPECT_NE(found.warnings[1].find("fiducial 4 does not fit"), std::string::npos) << found.warnings[1];
}

TEST(RegisterFiducials, WarnsThatMarksCloseToALineMayTurn) {
  const std::vector<Vec3> thin{{0, 0, 0}, {0, 0, 40}, {0, 0, 80}, {5, 0, 40}};
  const Registration found = register_fiducials(thin, as_measured(thin, 0.0, 1), {.fle_mm = 3.0});
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_NE(found.warnings[0].find("may turn"), std::string::npos) << found.warnings[0];
  EXPECT_NE(found.warnings[0].find("foot to head"), std::string::npos) << found.warnings[0];
}

TEST(RegisterFiducials, RejectsWhatHoldsNoPose) {
  const std::vector<Vec3> two{{0, 0, 0}, {10, 0, 0}};
  EXPECT_THROW(register_fiducials(two, two), Error);
  const std::vector<Vec3> line{{0, 0, 0}, {10, 0, 0}, {20, 0, 0}, {50, 0, 0}};
  EXPECT_THROW(register_fiducials(line, line), Error);
  std::vector<Vec3> broken = kMarks;
  broken[2].x() = test::kNan;
  EXPECT_THROW(register_fiducials(kMarks, broken), Error);
  EXPECT_THROW(register_fiducials(kMarks, kMarks, {.fle_mm = test::kNan}), Error);
  std::vector<Vec3> fewer(kMarks.begin(), kMarks.end() - 1);
  EXPECT_THROW(register_fiducials(kMarks, fewer), Error);
}

}  // namespace
}  // namespace spinaltap
