#include "core/anatomy/pedicle_section.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

namespace spinaltap {
namespace {

/// A rod along y whose section is an ellipse with these half diameters along x and z; near its surface, a distance.
class Rod : public ScalarField {
 public:
  Rod(double a_mm, double b_mm) : a_mm_(a_mm), b_mm_(b_mm) {}
  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                std::span<Vec3> gradients) const override {
    for (std::size_t n = 0; n < points_mm.size(); ++n) {
      values_mm[n] = value_mm(points_mm[n]);
      if (gradients.empty()) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = 1e-5 * Vec3::Unit(axis);
        gradients[n][axis] = (value_mm(points_mm[n] + step) - value_mm(points_mm[n] - step)) / 2e-5;
      }
    }
  }

 private:
  double value_mm(const Vec3& p) const {
    const double radial = std::hypot(p.x() / a_mm_, p.z() / b_mm_);
    const double slope = std::hypot(p.x() / (a_mm_ * a_mm_), p.z() / (b_mm_ * b_mm_)) / std::max(radial, 1e-9);
    return std::max((radial - 1.0) / std::max(slope, 1.0 / b_mm_), std::abs(p.y()) - 12.0);
  }
  double a_mm_, b_mm_;
};

BoneShape rod(double a_mm, double b_mm) {
  return BoneShape(std::make_shared<Rod>(a_mm, b_mm), Box3(Vec3(-9, -13, -9), Vec3(9, 13, 9)), 0.3);
}

TEST(BoneSection, HasTheAreaCentreAndSizeOfAnEllipse) {
  const BoneShape bone = rod(3.5, 6.5);
  const BoneSection section =
      sharpened(bone, section_around(bone, Vec3(1.0, 2.0, -2.0), -Vec3::UnitY(), Vec3::UnitZ()));
  ASSERT_TRUE(section.inside);
  EXPECT_EQ(section.endless, 0);
  // A polygon of 64 corners is 0.2% smaller than its ellipse.
  EXPECT_NEAR(section.area_mm2, std::numbers::pi * 3.5 * 6.5, 0.3);
  EXPECT_LE((section.centre_mm - Vec3(0, 2, 0)).norm(), 0.02);
  const SectionSize size = size_of(section);
  EXPECT_NEAR(size.small_mm, 7.0, 0.02);
  EXPECT_NEAR(size.large_mm, 13.0, 0.03);
  EXPECT_NEAR(std::abs(size.small_axis.x()), 1.0, 1e-4);
  EXPECT_NEAR(std::abs(size.large_axis.z()), 1.0, 1e-4);
}

TEST(BoneSection, GrowsWithTheTiltOfItsPlane) {
  const BoneShape bone = rod(3.5, 5.0);
  const double tilt = 20.0 * std::numbers::pi / 180.0;
  const Vec3 normal(std::sin(tilt), -std::cos(tilt), 0.0);
  const BoneSection section = section_around(bone, Vec3::Zero(), normal, Vec3::UnitZ());
  EXPECT_NEAR(section.area_mm2, std::numbers::pi * 3.5 * 5.0 / std::cos(tilt), 0.4);
}

TEST(BoneSection, IsNoneOutsideTheBone) {
  const BoneShape bone = rod(6.0, 8.0);
  EXPECT_FALSE(section_around(bone, Vec3(8.5, 0.0, 8.5), Vec3::UnitY(), Vec3::UnitZ()).inside);
}

}  // namespace
}  // namespace spinaltap
