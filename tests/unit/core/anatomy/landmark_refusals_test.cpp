#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "core/anatomy/landmarks.h"
#include "core/base/error.h"
#include "tests/support/made_bone_shape.h"
#include "tests/support/release_only.h"
#include "tests/support/stacked_vertebrae.h"

namespace spinaltap {
namespace {

using ::testing::HasSubstr;

/// A solid by formula, whose value changes by at most 1 mm a mm.
class FormulaSolid : public Solid {
 public:
  FormulaSolid(std::function<double(const Vec3&)> value_mm, const Box3& bounds_mm)
      : value_mm_(std::move(value_mm)), bounds_mm_(bounds_mm) {}
  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3>) const override {
    for (std::size_t n = 0; n < points_mm.size(); ++n) values_mm[n] = value_mm_(points_mm[n]);
  }
  Box3 bounds_mm() const override { return bounds_mm_; }
  double hu(const Vec3&, double, double) const override { return 300.0; }

 private:
  std::function<double(const Vec3&)> value_mm_;
  Box3 bounds_mm_;
};

std::string rejection_of(const Solid& solid) {
  try {
    (void)find_landmarks(test::shape_of(solid));
  } catch (const Error& error) {
    std::printf("%s\n", error.what());
    return error.what();
  }
  return "";
}

TEST(LandmarkRejections, TwoVertebraeThatDoNotTouch) {
  RELEASE_ONLY();
  EXPECT_THAT(rejection_of(test::StackedVertebrae(2, 48.0, Vec3::Zero())), HasSubstr("expected one vertebra"));
}

TEST(LandmarkRejections, TwoVertebraeWhoseJointsTouch) {
  RELEASE_ONLY();
  EXPECT_THAT(rejection_of(test::StackedVertebrae(2, 33.0, Vec3(10, 0, 0))), HasSubstr("expected one vertebra"));
}

TEST(LandmarkRejections, TwoVertebraeWhoseBodiesAreFused) {
  RELEASE_ONLY();
  EXPECT_THAT(rejection_of(test::StackedVertebrae(2, 26.0, Vec3(0, 5, 0))), HasSubstr("expected one vertebra"));
}

TEST(LandmarkRejections, ABoneWithoutACanal) {
  const FormulaSolid ball([](const Vec3& p) { return (p.cwiseProduct(Vec3(1, 0.8, 0.9))).norm() - 20.0; },
                          Box3(Vec3::Constant(-28.0), Vec3::Constant(28.0)));
  EXPECT_THAT(rejection_of(ball), HasSubstr("no canal"));
}

TEST(LandmarkRejections, ARingWithoutABody) {
  const FormulaSolid ring([](const Vec3& p) { return std::hypot(std::hypot(p.x(), p.y()) - 14.0, p.z()) - 6.0; },
                          Box3(Vec3(-21, -21, -7), Vec3(21, 21, 7)));
  EXPECT_NE(rejection_of(ring), "");
}

TEST(LandmarkRejections, AGridWithoutBone) {
  const FormulaSolid nothing([](const Vec3&) { return 5.0; }, Box3(Vec3::Constant(-20.0), Vec3::Constant(20.0)));
  EXPECT_THAT(rejection_of(nothing), HasSubstr("no surface"));
}

}  // namespace
}  // namespace spinaltap
