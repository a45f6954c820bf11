#include "core/registration/pose_covariance.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/registration/detail/matrix6.h"

namespace spinaltap {
namespace {

/// What a place near to `p` moves by, of turn and shift.
Eigen::Matrix<double, 3, 6> motion_at(const PoseCovariance& covariance, const Vec3& p_mm) {
  Eigen::Matrix<double, 3, 6> motion;
  const Vec3 arm = p_mm - covariance.centre_mm;
  motion.leftCols<3>() << 0.0, arm.z(), -arm.y(), -arm.z(), 0.0, arm.x(), arm.y(), -arm.x(), 0.0;
  motion.rightCols<3>().setIdentity();
  return motion;
}

const char* words_of(const Vec3& axis) {
  constexpr const char* kWords[]{"right to left", "front to back", "foot to head"};
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return kWords[largest];
}

}  // namespace

namespace detail {

Matrix6 whole_matrix(const PoseCovariance& covariance) {
  Matrix6 whole;
  whole << covariance.turn_rad2, covariance.turn_shift, covariance.turn_shift.transpose(), covariance.shift_mm2;
  return whole;
}

PoseCovariance covariance_of(const Matrix6& whole, const Vec3& centre_mm) {
  return {centre_mm, whole.topLeftCorner<3, 3>(), whole.topRightCorner<3, 3>(), whole.bottomRightCorner<3, 3>()};
}

}  // namespace detail

Mat3 target_covariance_mm2(const PoseCovariance& covariance, const Vec3& p_mm) {
  const Eigen::Matrix<double, 3, 6> motion = motion_at(covariance, p_mm);
  return motion * detail::whole_matrix(covariance) * motion.transpose();
}

double target_error_mm(const PoseCovariance& covariance, const Vec3& p_mm) {
  return std::sqrt(std::max(0.0, target_covariance_mm2(covariance, p_mm).trace()));
}

double target_error_along_mm(const PoseCovariance& covariance, const Vec3& p_mm, const Vec3& direction) {
  if (!(direction.norm() > 0.0)) fail("target error: expected a direction that is not zero");
  const Vec3 unit = direction.normalized();
  return std::sqrt(std::max(0.0, unit.dot(target_covariance_mm2(covariance, p_mm) * unit)));
}

std::vector<WeakMotion> weak_motions(const PoseCovariance& covariance, double reach_mm, double limit_mm) {
  const double reach = std::max(reach_mm, 1e-3);
  // Turns as what they do at the reach, so that all six are lengths.
  detail::Vector6 scale;
  scale << reach, reach, reach, 1.0, 1.0, 1.0;
  const detail::Matrix6 lengths = scale.asDiagonal() * detail::whole_matrix(covariance) * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<detail::Matrix6> solver(lengths);
  std::vector<WeakMotion> motions;
  for (Eigen::Index n = 5; n >= 0; --n) {
    const double at_points_mm = std::sqrt(std::max(0.0, solver.eigenvalues()[n]));
    if (!(at_points_mm > limit_mm)) break;
    const detail::Vector6 motion = solver.eigenvectors().col(n);
    const Vec3 turn = motion.head<3>(), shift = motion.tail<3>();
    WeakMotion weak;
    weak.at_points_mm = at_points_mm;
    weak.is_turn = turn.norm() > shift.norm();
    const Vec3& larger = weak.is_turn ? turn : shift;
    weak.size = at_points_mm * larger.norm() * (weak.is_turn ? 1.0 / (reach * kDegree) : 1.0);
    weak.axis = larger.normalized();
    // One of two signs, always the same.
    Eigen::Index largest = 0;
    weak.axis.cwiseAbs().maxCoeff(&largest);
    if (weak.axis[largest] < 0.0) weak.axis = -weak.axis;
    motions.push_back(weak);
  }
  return motions;
}

std::string in_words(const WeakMotion& motion) {
  const std::string axis = "(" + fixed_text(motion.axis.x(), 2) + ", " + fixed_text(motion.axis.y(), 2) + ", " +
                           fixed_text(motion.axis.z(), 2) + "), mostly " + words_of(motion.axis);
  if (!motion.is_turn) return "may slide " + fixed_text(motion.size, 1) + " mm along " + axis;
  return "may turn " + fixed_text(motion.size, 1) + " degrees about " + axis + ", which is " +
         fixed_text(motion.at_points_mm, 1) + " mm at the points";
}

void check_covariance(const PoseCovariance& covariance) {
  const detail::Matrix6 whole = detail::whole_matrix(covariance);
  if (!whole.allFinite() || !covariance.centre_mm.allFinite()) {
    fail("covariance of a pose: expected finite numbers, found others");
  }
  if (!((whole - whole.transpose()).cwiseAbs().maxCoeff() <= 1e-6 * std::max(1e-6, whole.cwiseAbs().maxCoeff()))) {
    fail("covariance of a pose: expected a symmetric matrix, found another");
  }
  const Eigen::SelfAdjointEigenSolver<detail::Matrix6> solver(whole, Eigen::EigenvaluesOnly);
  const double largest = solver.eigenvalues()[5];
  if (!(solver.eigenvalues()[0] >= -1e-9 * std::max(1.0, largest))) {
    fail("covariance of a pose: expected no negative variance, found ", solver.eigenvalues()[0]);
  }
}

PoseError pose_error_of(const PoseCovariance& covariance, const Vec3& normals_a, const Vec3& normals_b) {
  const Eigen::SelfAdjointEigenSolver<detail::Matrix6> solver(detail::whole_matrix(covariance));
  detail::Vector6 normals;
  normals << normals_a, normals_b;
  const detail::Vector6 deviations = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const detail::Vector6 error = solver.eigenvectors() * deviations.cwiseProduct(normals);
  return {error.head<3>(), error.tail<3>()};
}

}  // namespace spinaltap
