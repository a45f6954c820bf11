#include "core/base/geometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"

namespace spinaltap {
namespace {

TEST(AnyPerpendicular, IsAUnitVectorAtRightAngles) {
  constexpr std::uint64_t kSeed = 8;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  for (std::uint64_t n = 0; n < 1000; ++n) {
    Vec3 axis(random_normal(kSeed, 3 * n), random_normal(kSeed, 3 * n + 1), random_normal(kSeed, 3 * n + 2));
    if (n < 6) axis = (n % 2 == 0 ? 1.0 : -1.0) * Vec3::Unit(static_cast<Eigen::Index>(n / 2));
    axis.normalize();
    const Vec3 across = any_perpendicular(axis);
    EXPECT_NEAR(across.norm(), 1.0, 1e-14);
    EXPECT_NEAR(across.dot(axis), 0.0, 1e-14);
    EXPECT_EQ(any_perpendicular(axis), across);
  }
}

TEST(AngleBetween, IsRightForSmallAngles) {
  for (const double angle : {0.0, 1e-12, 1e-6, 0.3, 1.5, 3.0, std::numbers::pi}) {
    const Vec3 turned(5.0 * std::cos(angle), 0.0, 5.0 * std::sin(angle));
    EXPECT_NEAR(angle_between_rad(2.0 * Vec3::UnitX(), turned), angle, 1e-15 + 1e-14 * angle);
  }
}

}  // namespace
}  // namespace spinaltap
