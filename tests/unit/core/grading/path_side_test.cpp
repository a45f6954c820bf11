#include "core/grading/path_side.h"

#include <gtest/gtest.h>

#include <cmath>

namespace spinaltap {
namespace {

TEST(PathAngles, AreThoseTheDirectionWasTurnedBy) {
  // Forward, turned by 20 degrees towards the middle, then lifted by 10.
  const double inward = 20.0 * kDegree, up = 10.0 * kDegree;
  for (const bool is_left : {true, false}) {
    const double side = is_left ? -1.0 : 1.0;
    const Vec3 direction(side * std::sin(inward) * std::cos(up), -std::cos(inward) * std::cos(up), std::sin(up));
    const PathAngles angles = path_angles(direction, Mat3::Identity(), is_left);
    EXPECT_NEAR(angles.convergence_deg, 20.0, 1e-9);
    EXPECT_NEAR(angles.inclination_deg, 10.0, 1e-9);
  }
}

TEST(PathAngles, TurnWithTheVertebra) {
  const Mat3 axes = Eigen::AngleAxisd(0.3, Vec3(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  const PathAngles angles = path_angles(axes * -Vec3::UnitY(), axes, true);
  EXPECT_NEAR(angles.convergence_deg, 0.0, 1e-9);
  EXPECT_NEAR(angles.inclination_deg, 0.0, 1e-9);
}

}  // namespace
}  // namespace spinaltap
