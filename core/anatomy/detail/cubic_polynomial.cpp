#include "core/anatomy/detail/cubic_polynomial.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace spinaltap {
namespace {

using Powers = std::array<int, 3>;

constexpr std::array<Powers, CubicPolynomial::kTerms> all_powers() {
  std::array<Powers, CubicPolynomial::kTerms> powers{};
  std::size_t count = 0;
  for (int a = 0; a <= 3; ++a) {
    for (int b = 0; a + b <= 3; ++b) {
      for (int c = 0; a + b + c <= 3; ++c) powers[count++] = {a, b, c};
    }
  }
  return powers;
}
constexpr std::array<Powers, CubicPolynomial::kTerms> kPowers = all_powers();

/// The derivative of x^power that `order` asks for.
double derived(double x, int power, int order) {
  double factor = 1.0;
  for (; order > 0; --order, --power) factor *= power;
  if (power < 0) return 0.0;
  for (; power > 0; --power) factor *= x;
  return factor;
}

/// The terms at a place, derived `orders` times along each axis.
Eigen::Matrix<double, CubicPolynomial::kTerms, 1> terms(const Vec3& at, const Powers& orders) {
  Eigen::Matrix<double, CubicPolynomial::kTerms, 1> row;
  for (std::size_t term = 0; term < kPowers.size(); ++term) {
    double product = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      product *= derived(at[static_cast<Eigen::Index>(axis)], kPowers[term][axis], orders[axis]);
    }
    row[static_cast<Eigen::Index>(term)] = product;
  }
  return row;
}

}  // namespace

void CubicPolynomial::add(const Vec3& place, double value, double weight) {
  const Row row = terms(place, {0, 0, 0});
  matrix_ += weight * row * row.transpose();
  right_ += weight * value * row;
}

std::optional<Vec3> CubicPolynomial::minimum() const {
  constexpr int kRounds = 10;
  constexpr double kMaxStep = 0.5, kMinBend = 1e-4;
  const Row form = matrix_.ldlt().solve(right_);
  if (!form.allFinite()) return std::nullopt;
  Vec3 at = Vec3::Zero();
  for (int round = 0; round < kRounds; ++round) {
    Vec3 slope;
    Mat3 bend;
    for (std::size_t a = 0; a < 3; ++a) {
      Powers orders{};
      ++orders[a];
      slope[static_cast<Eigen::Index>(a)] = terms(at, orders).dot(form);
      for (std::size_t b = 0; b < 3; ++b) {
        Powers twice = orders;
        ++twice[b];
        bend(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) = terms(at, twice).dot(form);
      }
    }
    if (!(Eigen::SelfAdjointEigenSolver<Mat3>(bend).eigenvalues()[0] > kMinBend)) return std::nullopt;
    const Vec3 step = -bend.ldlt().solve(slope);
    at += step.cwiseMax(-kMaxStep).cwiseMin(kMaxStep);
    at = at.cwiseMax(-1.0).cwiseMin(1.0);
  }
  return at;
}

}  // namespace spinaltap
