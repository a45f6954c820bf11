#include "core/anatomy/detail/cubic_polynomial.h"

#include <gtest/gtest.h>

#include <functional>

namespace spinaltap {
namespace {

/// A form through a function's values on a grid of 5^3 places.
CubicPolynomial through(const std::function<double(const Vec3&)>& value) {
  CubicPolynomial form;
  for (int i = -2; i <= 2; ++i) {
    for (int j = -2; j <= 2; ++j) {
      for (int k = -2; k <= 2; ++k) {
        const Vec3 place = 0.5 * Vec3(i, j, k);
        form.add(place, value(place), 1.0 + 0.1 * i);
      }
    }
  }
  return form;
}

TEST(CubicPolynomial, FindsTheMinimumOfACubic) {
  // Its slope is zero at (0.2, -0.1, 0.3) by construction, and it bends upward there.
  const Vec3 lowest(0.2, -0.1, 0.3);
  const auto value = [&](const Vec3& p) {
    const Vec3 q = p - lowest;
    return 3.0 + q.squaredNorm() + 0.3 * q.x() * q.y() + 0.4 * q.x() * q.x() * q.x() - 0.2 * q.y() * q.z() * q.z();
  };
  const std::optional<Vec3> found = through(value).minimum();
  ASSERT_TRUE(found.has_value());
  EXPECT_LE((*found - lowest).norm(), 1e-9);
}

TEST(CubicPolynomial, StaysInTheCube) {
  const std::optional<Vec3> found = through([](const Vec3& p) { return (p - Vec3(3, 0, 0)).squaredNorm(); }).minimum();
  ASSERT_TRUE(found.has_value());
  EXPECT_LE((*found - Vec3(1, 0, 0)).norm(), 1e-9);
}

TEST(CubicPolynomial, HasNoMinimumWhereASaddleIs) {
  EXPECT_FALSE(through([](const Vec3& p) { return p.x() * p.x() - p.y() * p.y() + p.z() * p.z(); }).minimum());
  EXPECT_FALSE(CubicPolynomial().minimum());
}

}  // namespace
}  // namespace spinaltap
