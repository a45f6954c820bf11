#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/rbf/rbf_fit.h"

namespace spinaltap {
namespace {

/// Rounding hides a singular system from the solver, so that points given twice are looked for.
bool has_duplicates(std::span<const Vec3> points_mm) {
  const auto less = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::vector<Vec3> sorted(points_mm.begin(), points_mm.end());
  std::sort(sorted.begin(), sorted.end(), less);
  return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
}

}  // namespace

RbfField interpolate_rbf(std::span<const Vec3> points_mm, std::span<const double> values_mm, double smoothing_mm) {
  constexpr std::size_t kMostPoints = 20'000;
  if (points_mm.size() < 4 || points_mm.size() > kMostPoints) {
    fail("RBF: expected 4 to ", kMostPoints, " points for the dense solver, found ", points_mm.size());
  }
  if (values_mm.size() != points_mm.size()) fail("RBF: expected a value for each point");
  if (!(smoothing_mm >= 0.0) || !std::isfinite(smoothing_mm))
    fail("RBF: expected smoothing of 0 mm or more, found ", smoothing_mm);
  const auto count = static_cast<Eigen::Index>(points_mm.size());
  Vec3 origin_mm = Vec3::Zero();
  for (const Vec3& p : points_mm) origin_mm += p;
  origin_mm /= static_cast<double>(count);
  Eigen::MatrixXd points(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) points.row(i) = (points_mm[static_cast<std::size_t>(i)] - origin_mm);
  if (!points.allFinite()) fail("RBF: a point is not a number");
  if (!std::all_of(values_mm.begin(), values_mm.end(), [](double value) { return std::isfinite(value); })) {
    fail("RBF: a value is not a number");
  }
  const Eigen::Vector3d spread = Eigen::JacobiSVD<Eigen::MatrixXd>(points.transpose() * points).singularValues();
  if (!(spread[2] > 1e-12 * spread[0])) fail("RBF: the points lie in a plane; a surface needs points that do not");

  if (smoothing_mm == 0.0 && has_duplicates(points_mm)) {
    fail("RBF: two points are the same; expected points that differ, or smoothing above 0 mm");
  }

  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(count + 4, count + 4);
  for (Eigen::Index j = 0; j < count; ++j) {
    system.col(j).head(count) = (points.rowwise() - points.row(j)).rowwise().norm();
    system(j, j) -= smoothing_mm;
  }
  system.block(0, count, count, 1).setOnes();
  system.block(0, count + 1, count, 3) = points;
  system.block(count, 0, 4, count) = system.block(0, count, count, 4).transpose();
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count + 4);
  for (Eigen::Index i = 0; i < count; ++i) right[i] = values_mm[static_cast<std::size_t>(i)];
  // In place: the system is the largest thing in memory.
  const Eigen::PartialPivLU<Eigen::Ref<Eigen::MatrixXd>> factors(system);
  const Eigen::VectorXd weights = factors.solve(right);
  if (!weights.allFinite()) fail("RBF: the system has no solution; are two points nearly the same?");
  return {std::vector<Vec3>(points_mm.begin(), points_mm.end()), weights, origin_mm};
}

}  // namespace spinaltap
