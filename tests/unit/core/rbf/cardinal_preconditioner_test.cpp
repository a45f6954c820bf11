// Compiled with optimisation: long loops of its own.

#include "core/rbf/detail/cardinal_preconditioner.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Dense>

#include "core/rbf/detail/polynomial.h"
#include "tests/unit/core/rbf/dense_solution.h"
#include "tests/unit/core/rbf/kernels.h"
#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap::detail {
namespace {

using test::kKernels;

constexpr std::uint64_t kCardinalSeed = 101;

CardinalPreconditioner preconditioner(RadialKernel kernel, const std::vector<Vec3>& points_mm, std::size_t neighbours,
                                      double smoothing_mm, const SimdKernels& simd = best_simd_kernels()) {
  const std::vector<double> smoothing(smoothing_mm > 0.0 ? points_mm.size() : 0, smoothing_mm);
  return {kernel, points_mm, smoothing, coarse_to_fine(points_mm, determining_points(kernel, points_mm), neighbours),
          simd};
}

Eigen::MatrixXd matrix_of(const CardinalPreconditioner& applied, std::size_t count) {
  Eigen::MatrixXd matrix(count, count);
  for (std::size_t j = 0; j < count; ++j) {
    std::vector<double> unit(count, 0.0);
    unit[j] = 1.0;
    std::vector<double> column(count);
    applied.apply(unit, column);
    for (std::size_t i = 0; i < count; ++i) {
      matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = column[i];
    }
  }
  return matrix;
}

/// The exact inverse on weights that the side conditions allow: the upper left block of the saddle matrix's inverse.
Eigen::MatrixXd exact_inverse(RadialKernel kernel, const std::vector<Vec3>& points_mm, double smoothing_mm) {
  const auto count = static_cast<Eigen::Index>(points_mm.size());
  return test::dense_matrix(kernel, points_mm, smoothing_mm, Vec3::Zero(), 10.0).inverse().topLeftCorner(count, count);
}

TEST(CardinalPreconditioner, IsTheExactInverseWithAllPointsAsNeighbours) {
  SCOPED_TRACE(::testing::Message() << "seed " << kCardinalSeed);
  const std::vector<Vec3> points_mm = test::random_points(70, kCardinalSeed);
  for (const RadialKernel kernel : kKernels) {
    for (const double smoothing_mm : {0.0, 0.5}) {
      const Eigen::MatrixXd found = matrix_of(preconditioner(kernel, points_mm, 69, smoothing_mm), 70);
      const Eigen::MatrixXd expected = exact_inverse(kernel, points_mm, smoothing_mm);
      // Functions are kept in float, and polynomials taken out by a penalty that leaves 1e-5 of them.
      EXPECT_LT((found - expected).norm(), 1e-4 * expected.norm())
          << (kernel == RadialKernel::biharmonic ? "bi" : "tri") << "harmonic, smoothing " << smoothing_mm;
    }
  }
}

TEST(CardinalPreconditioner, IsSymmetricAndOfOneSign) {
  SCOPED_TRACE(::testing::Message() << "seed " << kCardinalSeed);
  for (const int set : {0, 1}) {
    const std::vector<Vec3> points_mm =
        set == 0 ? test::random_points(120, kCardinalSeed) : test::clustered_points(120, kCardinalSeed);
    for (const RadialKernel kernel : kKernels) {
      const auto terms = static_cast<Eigen::Index>(polynomial_terms(kernel));
      const Eigen::MatrixXd found = matrix_of(preconditioner(kernel, points_mm, 30, 0.0), 120);
      // Sums of the same products in the same order, but for the last rounding.
      EXPECT_LE((found - found.transpose()).cwiseAbs().maxCoeff(), 1e-14 * found.cwiseAbs().maxCoeff());
      const Eigen::MatrixXd signed_matrix = kernel == RadialKernel::biharmonic ? Eigen::MatrixXd(-found) : found;
      // Scaled to ones on the diagonal, so that clusters do not hide the rest; the determining points have no
      // functions.
      const Eigen::VectorXd scale = signed_matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
      const Eigen::VectorXd eigenvalues =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scale.asDiagonal() * signed_matrix * scale.asDiagonal())
              .eigenvalues();
      EXPECT_GT(eigenvalues[0], -1e-12);
      // Cubes of distances in clusters of such different sizes leave less than rounding of some functions.
      if (kernel == RadialKernel::triharmonic && set == 1) continue;
      EXPECT_GT(eigenvalues[terms], 1e-12) << "as many are positive as there are functions";
    }
  }
}

TEST(CardinalPreconditioner, KeepsTheSideConditionsInFloat) {
  SCOPED_TRACE(::testing::Message() << "seed " << kCardinalSeed);
  const std::vector<Vec3> points_mm = test::ball_points(400);
  const CardinalPreconditioner applied = preconditioner(RadialKernel::biharmonic, points_mm, 40, 0.0);
  std::vector<double> out(400);
  applied.apply(test::random_weights(400, kCardinalSeed + 1), out);
  double sum = 0.0;
  double size = 0.0;
  Vec3 moment = Vec3::Zero();
  for (std::size_t i = 0; i < 400; ++i) {
    sum += out[i];
    moment += out[i] * points_mm[i];
    size += std::abs(out[i]);
  }
  EXPECT_LT(std::abs(sum), 1e-5 * size);         // the penalty's share
  EXPECT_LT(moment.norm(), 1e-5 * 10.0 * size);  // points lie 10 mm from the origin
}

TEST(CardinalPreconditioner, IsNearlyTheInverseWithFewNeighbours) {
  SCOPED_TRACE(::testing::Message() << "seed " << kCardinalSeed);
  const std::vector<Vec3> points_mm = test::ball_points(300);
  const Eigen::MatrixXd found = matrix_of(preconditioner(RadialKernel::biharmonic, points_mm, 40, 0.0), 300);
  const Eigen::MatrixXd matrix = test::dense_matrix(RadialKernel::biharmonic, points_mm, 0.0, Vec3::Zero(), 10.0);
  // On the space that the side conditions leave, the product's eigenvalues are 1 for the exact inverse.
  const Eigen::MatrixXd polynomials = matrix.topRightCorner(300, 4);
  const Eigen::MatrixXd all = polynomials.householderQr().householderQ();
  const Eigen::MatrixXd allowed = all.rightCols(296);
  const Eigen::VectorXcd eigenvalues =
      ((allowed.transpose() * found * allowed) * (allowed.transpose() * matrix.topLeftCorner(300, 300) * allowed))
          .eigenvalues();
  // A few dozen iterations reach 1e-6 when they lie within a factor of ten or so.
  EXPECT_GT(eigenvalues.real().minCoeff(), 0.2);
  EXPECT_LT(eigenvalues.real().maxCoeff(), 5.0);
  EXPECT_LT(eigenvalues.imag().cwiseAbs().maxCoeff(), 1e-3);
}

TEST(CardinalPreconditioner, GivesTheSameBitsAtAnyNumberOfThreadsAndWithAnyInstructionSet) {
  SCOPED_TRACE(::testing::Message() << "seed " << kCardinalSeed);
  const std::vector<Vec3> points_mm = test::clustered_points(1500, kCardinalSeed);
  const std::vector<double> in = test::random_weights(1500, kCardinalSeed + 1);
  for (const RadialKernel kernel : kKernels) {
    const auto run = [&](std::size_t threads, const SimdKernels& simd) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      std::vector<double> out(1500);
      preconditioner(kernel, points_mm, 30, 0.1, simd).apply(in, out);
      return out;
    };
    const std::vector<double> expected = run(1, simd_kernels().front());
    for (const SimdKernels& simd : simd_kernels()) EXPECT_EQ(run(2, simd), expected) << simd.name;
  }
}

}  // namespace
}  // namespace spinaltap::detail
