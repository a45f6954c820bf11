#include "core/rbf/detail/polynomial.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <set>

#include "tests/support/error_of.h"
#include "tests/unit/core/rbf/kernels.h"
#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap {
namespace {

using detail::determining_points;
using test::error_of;
using testing::HasSubstr;

constexpr std::uint64_t kPolynomialSeed = 19;

TEST(Polynomial, IsTheSumThatItsCoefficientsSay) {
  const std::vector<double> linear{1.0, 2.0, 3.0, 4.0};
  const Vec3 d(1.0, -2.0, 0.5);
  EXPECT_EQ(polynomial_value(RadialKernel::biharmonic, linear, d), 1.0 + 2.0 - 6.0 + 2.0);
  EXPECT_EQ(polynomial_gradient(RadialKernel::biharmonic, linear, d), Vec3(2, 3, 4));
  const std::vector<double> quadratic{1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0};
  // xx, xy, xz, yy, yz, zz = 1, -2, 0.5, 4, -1, 0.25.
  EXPECT_EQ(polynomial_value(RadialKernel::triharmonic, quadratic, d), -1.0 + 5.0 - 12.0 + 3.5 + 32.0 - 9.0 + 2.5);
  EXPECT_EQ(polynomial_gradient(RadialKernel::triharmonic, quadratic, d),
            Vec3(2.0 + 10.0 - 12.0 + 3.5, 3.0 + 6.0 - 32.0 + 4.5, 4.0 + 7.0 - 18.0 + 10.0));
}

TEST(DeterminingPoints, DetermineThePolynomialWell) {
  SCOPED_TRACE(::testing::Message() << "seed " << kPolynomialSeed);
  for (const RadialKernel kernel : test::kKernels) {
    const auto terms = static_cast<Eigen::Index>(polynomial_terms(kernel));
    for (const double reach_mm : {1e-3, 10.0, 1e5}) {
      const std::vector<Vec3> points_mm = test::random_points(500, kPolynomialSeed, reach_mm);
      const std::vector<std::uint32_t> found = determining_points(kernel, points_mm);
      ASSERT_EQ(std::set<std::uint32_t>(found.begin(), found.end()).size(), polynomial_terms(kernel));
      Eigen::MatrixXd rows(terms, terms);
      for (Eigen::Index i = 0; i < terms; ++i) {
        const auto row = polynomial_row(kernel, points_mm[found[static_cast<std::size_t>(i)]] / reach_mm);
        for (Eigen::Index k = 0; k < terms; ++k) rows(i, k) = row[static_cast<std::size_t>(k)];
      }
      // Complete pivoting keeps every pivot near 1; the best ten points of a cube come to a condition of about 10.
      const Eigen::VectorXd singular = rows.jacobiSvd().singularValues();
      EXPECT_LT(singular[0] / singular[terms - 1], 100.0);
    }
  }
}

TEST(DeterminingPoints, RejectPointsThatDoNotDetermineIt) {
  SCOPED_TRACE(::testing::Message() << "seed " << kPolynomialSeed);
  const Vec3 away(500, 600, 700);
  std::vector<Vec3> plane, line, heap, ball, cone;
  for (std::uint64_t n = 0; n < 80; ++n) {
    const Vec3 p = test::random_place(kPolynomialSeed, n);
    plane.push_back(away + p.x() * Vec3(1, 2, 3).normalized() + p.y() * Vec3(3, 0, -1).normalized());
    line.push_back(away + p.x() * Vec3(1, 2, 3).normalized());
    heap.push_back(away);
    ball.push_back(away + 10.0 * p.normalized());
    cone.push_back(away + Vec3(p.x(), p.y(), std::hypot(p.x(), p.y())));
  }
  const auto error = [](RadialKernel kernel, const std::vector<Vec3>& points_mm) {
    return error_of([&] { determining_points(kernel, points_mm); });
  };
  for (const auto& flat : {plane, line, heap}) {
    EXPECT_THAT(error(RadialKernel::biharmonic, flat), HasSubstr("lie in a plane"));
    EXPECT_THAT(error(RadialKernel::triharmonic, flat), HasSubstr("on a quadric"));
  }
  for (const auto& quadric : {ball, cone}) {
    EXPECT_EQ(error(RadialKernel::biharmonic, quadric), "");
    EXPECT_THAT(error(RadialKernel::triharmonic, quadric), HasSubstr("on a quadric"));
  }
  EXPECT_THAT(error(RadialKernel::biharmonic, {away, away, away}), HasSubstr("expected 4 points or more"));
  EXPECT_THAT(error(RadialKernel::triharmonic, test::random_points(9, kPolynomialSeed)), HasSubstr("found 9"));
}

}  // namespace
}  // namespace spinaltap
