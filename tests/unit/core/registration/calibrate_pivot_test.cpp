#include "core/registration/calibrate_pivot.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <cmath>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

const Vec3 kTip(3.0, -2.0, 140.0), kDimple(-80.0, 40.0, -1200.0);

/// Poses all over a cone about the tool's z, turned about their own axis too, with noise of their place.
std::vector<RigidPose> swept(double cone_deg, std::size_t count, double noise_mm, std::uint64_t seed) {
  std::vector<RigidPose> poses;
  for (std::size_t n = 0; n < count; ++n) {
    const double turn = 2.0 * std::numbers::pi * random_uniform(seed, 8 * n);
    // Of its own: together with the turn it would be a turn about one axis.
    const double spin = 2.0 * std::numbers::pi * random_uniform(seed + 77, n);
    const double lean = cone_deg * kDegree;
    const Mat3 rotation = (Eigen::AngleAxisd(turn, Vec3::UnitZ()) * Eigen::AngleAxisd(lean, Vec3::UnitX()) *
                           Eigen::AngleAxisd(spin, Vec3::UnitZ()))
                              .toRotationMatrix();
    Vec3 noise;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      noise[static_cast<Eigen::Index>(axis)] = noise_mm * random_normal(seed, 8 * n + 1 + axis);
    }
    poses.push_back({rotation, kDimple - rotation * kTip + noise});
  }
  return poses;
}

TEST(CalibratePivot, FindsTheTipOfATurnedTool) {
  const PivotCalibration found = calibrate_pivot(swept(30.0, 50, 0.0, 1));
  EXPECT_LT((found.tip_mm - kTip).norm(), 1e-8);
  EXPECT_LT((found.pivot_mm - kDimple).norm(), 1e-8);
  EXPECT_LT(found.residual_rms_mm, 1e-8);
  EXPECT_NEAR(found.cone_deg, 30.0, 4.0);  // 50 random turns are not quite even
  EXPECT_TRUE(found.warnings.empty());
}

TEST(CalibratePivot, SaysHowWellTheTipIsKnown) {
  constexpr int kTrials = 500;
  const double noise_mm = 0.25;
  Mat3 scatter = Mat3::Zero(), told = Mat3::Zero();
  for (int n = 0; n < kTrials; ++n) {
    // The same turns, with noise of their own.
    std::vector<RigidPose> poses = swept(25.0, 60, 0.0, 5);
    for (std::size_t k = 0; k < poses.size(); ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        poses[k].translation_mm[static_cast<Eigen::Index>(axis)] +=
            noise_mm * random_normal(static_cast<std::uint64_t>(n) + 100, 3 * k + axis);
      }
    }
    const PivotCalibration found = calibrate_pivot(poses);
    scatter += (found.tip_mm - kTip) * (found.tip_mm - kTip).transpose() / kTrials;
    told += found.tip_covariance_mm2 / kTrials;
  }
  // Variances of 500 normal numbers scatter by 6 %.
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(told(axis, axis) / scatter(axis, axis), 1.0, 0.25) << axis;
}

TEST(CalibratePivot, RefusesAConeThatIsTooSmall) {
  EXPECT_THROW(calibrate_pivot(swept(6.0, 200, 0.1, 1)), Error);
  EXPECT_NO_THROW(calibrate_pivot(swept(6.0, 200, 0.1, 1), {.min_cone_deg = 5.0}));
  // Turned about one axis only, as far as it will: nothing tells where along it the tip is.
  std::vector<RigidPose> spun;
  for (int n = 0; n < 40; ++n) {
    const Mat3 rotation = Eigen::AngleAxisd(0.15 * n, Vec3::UnitZ()).toRotationMatrix();
    spun.push_back({rotation, kDimple - rotation * kTip});
  }
  EXPECT_THROW(calibrate_pivot(spun), Error);
}

TEST(CalibratePivot, TellsThatTheTipSlipped) {
  std::vector<RigidPose> poses = swept(30.0, 80, 0.1, 3);
  poses[40].translation_mm.x() += 4.0;
  const PivotCalibration found = calibrate_pivot(poses);
  ASSERT_EQ(found.warnings.size(), 1U);
  EXPECT_NE(found.warnings[0].find("the tip moved: 1 of 80 poses"), std::string::npos) << found.warnings[0];
  EXPECT_TRUE(calibrate_pivot(swept(30.0, 80, 0.1, 3)).warnings.empty());
}

TEST(CalibratePivot, RejectsFewPosesAndWhatIsNoRotation) {
  EXPECT_THROW(calibrate_pivot(swept(30.0, 5, 0.0, 1)), Error);
  std::vector<RigidPose> poses = swept(30.0, 20, 0.0, 1);
  poses[3].rotation *= 1.1;
  EXPECT_THROW(calibrate_pivot(poses), Error);
}

}  // namespace
}  // namespace spinaltap
