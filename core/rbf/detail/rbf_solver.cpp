#include "core/rbf/detail/rbf_solver.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/rbf/detail/polynomial.h"

namespace spinaltap::detail {
namespace {

constexpr std::size_t kNeighbours = 40;
constexpr std::size_t kLeafSize = 128;

Eigen::Index as_index(std::size_t i) { return static_cast<Eigen::Index>(i); }

std::span<const double> span_of(const Eigen::VectorXd& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }
std::span<double> span_of(Eigen::VectorXd& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }

}  // namespace

RbfSolver::RbfSolver(RadialKernel kernel, std::vector<Vec3> points_mm, std::vector<double> smoothing_mm)
    : kernel_(kernel), points_mm_(std::move(points_mm)), smoothing_mm_(std::move(smoothing_mm)) {
  const std::vector<std::uint32_t> first = determining_points(kernel, points_mm_);
  const Box3 bounds = bounds_of(points_mm_);
  origin_mm_ = bounds.center();
  extent_mm_ = 0.5 * bounds.sizes().maxCoeff();

  const std::size_t count = points_mm_.size();
  const std::size_t terms = polynomial_terms(kernel);
  basis_.resize(as_index(count), as_index(terms));
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = polynomial_row(kernel, (points_mm_[i] - origin_mm_) / extent_mm_);
    for (std::size_t k = 0; k < terms; ++k) basis_(as_index(i), as_index(k)) = row[k];
  }
  // Modified Gram-Schmidt, twice; `triangle` ends as R of P = Q R.
  Eigen::MatrixXd triangle = Eigen::MatrixXd::Identity(as_index(terms), as_index(terms));
  for (Eigen::Index k = 0; k < as_index(terms); ++k) {
    for (int pass = 0; pass < 2; ++pass) {
      for (Eigen::Index l = 0; l < k; ++l) {
        const double dot = basis_.col(k).dot(basis_.col(l));
        basis_.col(k) -= dot * basis_.col(l);
        triangle(l, k) = (pass == 0 ? 0.0 : triangle(l, k)) + dot;
      }
    }
    triangle(k, k) = basis_.col(k).norm();
    basis_.col(k) /= triangle(k, k);
  }
  to_coefficients_ =
      triangle.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(as_index(terms), as_index(terms)));
  for (std::size_t k = 1; k < terms; ++k) {
    to_coefficients_.row(as_index(k)) /= k < 4 ? extent_mm_ : extent_mm_ * extent_mm_;
  }
  preconditioner_ = std::make_unique<CardinalPreconditioner>(
      kernel, points_mm_, smoothing_mm_, coarse_to_fine(points_mm_, first, std::min(kNeighbours, count - 1)),
      best_simd_kernels());
}

void RbfSolver::use_order(int order) {
  if (sum_ && order == order_) return;
  order_ = order;
  sum_.reset();  // before the next one takes memory
  // One leaf with all points is summed term by term.
  const std::size_t leaf_size = order > kMaxOrder ? points_mm_.size() : kLeafSize;
  sum_ = std::make_unique<FastSum>(
      kernel_, 0.0, points_mm_,
      FastSumOptions{.order = std::min(order, kMaxOrder), .leaf_size = leaf_size, .anywhere = false});
}

RbfSolver::Vector RbfSolver::multiply(const Vector& weights) {
  sum_->set_weights(span_of(weights));
  Vector product(weights.size());
  sum_->at_centres(span_of(product));
  const double sign = definite_sign(kernel_);
  for (std::size_t i = 0; i < smoothing_mm_.size(); ++i)
    product[as_index(i)] += sign * smoothing_mm_[i] * weights[as_index(i)];
  return product;
}

void RbfSolver::project(Vector& vector) const {
  for (Eigen::Index k = 0; k < basis_.cols(); ++k) vector -= basis_.col(k).dot(vector) * basis_.col(k);
}

double RbfSolver::sum_error(const Vector& weights, const Vector& product) const {
  constexpr std::size_t kSamples = 256;
  const std::size_t count = points_mm_.size();
  const std::size_t step = std::max<std::size_t>(1, count / kSamples);
  std::vector<Vec3> places_mm;
  std::vector<double> fast;
  const double sign = definite_sign(kernel_);
  for (std::size_t i = step / 2; i < count; i += step) {
    places_mm.push_back(points_mm_[i]);
    fast.push_back(product[as_index(i)] -
                   (smoothing_mm_.empty() ? 0.0 : sign * smoothing_mm_[i] * weights[as_index(i)]));
  }
  std::vector<double> direct(places_mm.size());
  direct_sums(kernel_, 0.0, points_mm_, span_of(weights), places_mm, direct, {});
  double largest = 0.0;
  for (std::size_t i = 0; i < fast.size(); ++i) largest = std::max(largest, std::abs(fast[i] - direct[i]));
  return largest;
}

int RbfSolver::improve(Vector& weights, Vector& residual, double target_mm, const Progress& progress) {
  constexpr int kMaxIterations = 40;
  std::vector<Vector> basis{residual / residual.norm()};
  std::vector<Vector> hessenberg;  // its columns
  const double start = residual.norm();
  const double start_max = residual.cwiseAbs().maxCoeff();
  Vector best_y;
  int done = 0;
  for (int step = 0; step < kMaxIterations; ++step) {
    progress.report("solving", std::clamp(std::log(start_max / std::max(1e-300, residual.cwiseAbs().maxCoeff())) /
                                              std::log(start_max / target_mm),
                                          0.0, 1.0));
    Vector direction(weights.size());
    preconditioner_->apply(span_of(basis.back()), span_of(direction));
    project(direction);  // the side conditions hold in float only
    Vector next = multiply(direction);
    project(next);
    Vector column = Vector::Zero(step + 2);
    for (int pass = 0; pass < 2; ++pass) {
      for (int j = 0; j <= step; ++j) {
        const double dot = basis[static_cast<std::size_t>(j)].dot(next);
        column[j] += dot;
        next -= dot * basis[static_cast<std::size_t>(j)];
      }
    }
    column[step + 1] = next.norm();
    hessenberg.push_back(column);
    done = step + 1;
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(done + 1, done);
    for (int j = 0; j < done; ++j) matrix.col(j).head(j + 2) = hessenberg[static_cast<std::size_t>(j)];
    Vector right = Vector::Zero(done + 1);
    right[0] = start;
    best_y = matrix.colPivHouseholderQr().solve(right);
    const Vector left = right - matrix * best_y;
    const bool ended = !(column[step + 1] > 1e-14 * start);
    if (!ended) basis.push_back(next / column[step + 1]);
    residual.setZero();
    for (std::size_t j = 0; j < basis.size(); ++j) residual += left[as_index(j)] * basis[j];
    if (ended || residual.cwiseAbs().maxCoeff() < target_mm) break;
  }
  // The preconditioner is linear: one more application gives the sum of all directions.
  Vector combined = Vector::Zero(weights.size());
  for (int j = 0; j < done; ++j) combined += best_y[j] * basis[static_cast<std::size_t>(j)];
  Vector step(weights.size());
  preconditioner_->apply(span_of(combined), span_of(step));
  project(step);
  weights += step;
  return done;
}

RbfSolver::Vector RbfSolver::choose_order(const Vector& weights, double accuracy_mm) {
  constexpr int kFirstOrder = 6;
  constexpr double kDigitsAnOrder = 0.8;
  for (int order = std::max(order_, kFirstOrder);;) {
    use_order(order);
    Vector product = multiply(weights);
    const double missing = std::min(100.0, std::log10(sum_error(weights, product) / accuracy_mm));
    if (!(missing > 0.0) || order > kMaxOrder) return product;
    const int next = order + std::max(1, static_cast<int>(missing / kDigitsAnOrder));
    order = order < kMaxOrder ? std::min(kMaxOrder, next) : next;
  }
}

RbfSolution RbfSolver::solve(std::span<const double> values_mm, double accuracy_mm, std::span<const double> start,
                             const Progress& progress) {
  constexpr int kMaxRounds = 12;
  constexpr double kSumShare = 0.1;  // of the accuracy, for errors of the fast sums at the points looked at
  constexpr double kSafety = 2.5;    // the sums' error anywhere, of that
  const std::size_t count = points_mm_.size();
  const Vector values = Eigen::Map<const Vector>(values_mm.data(), as_index(count));
  Vector weights = Vector::Zero(as_index(count));
  Vector product = weights;  // the matrix times them
  if (start.empty()) {
    // The preconditioner alone gives weights of about the solution's size, which the sums' error depends on.
    Vector right = values;
    project(right);
    Vector likely(as_index(count));
    preconditioner_->apply(span_of(right), span_of(likely));
    project(likely);
    choose_order(likely, kSumShare * accuracy_mm);
  } else {
    weights = Eigen::Map<const Vector>(start.data(), as_index(count));
    project(weights);
    product = choose_order(weights, kSumShare * accuracy_mm);
  }
  RbfSolution solution;
  for (int round = 0;; ++round) {
    solution.sum_error_mm = kSafety * sum_error(weights, product);
    Vector residual = values - product;
    const Vector in_basis = basis_.transpose() * residual;
    project(residual);
    solution.max_residual_mm = residual.cwiseAbs().maxCoeff();
    if (solution.max_residual_mm + solution.sum_error_mm <= accuracy_mm) {
      solution.model.polynomial.resize(polynomial_terms(kernel_));
      const Vector coefficients = to_coefficients_ * in_basis;
      std::copy(coefficients.begin(), coefficients.end(), solution.model.polynomial.begin());
      break;
    }
    if (solution.sum_error_mm > 0.5 * accuracy_mm) {
      if (order_ > kMaxOrder) {
        fail("RBF: expected an accuracy that sums of this size can reach, about ", 4.0 * solution.sum_error_mm,
             " mm here, found ", accuracy_mm);
      }
      product = choose_order(weights, kSumShare * accuracy_mm);
      continue;
    }
    if (round == kMaxRounds) {
      fail("RBF: expected to reach ", accuracy_mm, " mm at all ", count, " points, reached ", solution.max_residual_mm,
           " mm; are points nearly the same, with values that differ?");
    }
    solution.iterations += improve(weights, residual, 0.4 * accuracy_mm, progress);
    product = multiply(weights);
  }
  solution.model.kernel = kernel_;
  solution.model.origin_mm = origin_mm_;
  solution.model.centres_mm = points_mm_;
  solution.model.weights.assign(weights.begin(), weights.end());
  return solution;
}

}  // namespace spinaltap::detail
