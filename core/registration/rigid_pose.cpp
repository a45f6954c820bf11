#include "core/registration/rigid_pose.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {

Vec3 RigidPose::apply(const Vec3& p_mm) const { return rotation * p_mm + translation_mm; }

RigidPose RigidPose::inverse() const {
  const Mat3 back = rotation.transpose();
  return {back, -(back * translation_mm)};
}

RigidPose RigidPose::after(const RigidPose& other) const {
  return {rotation * other.rotation, rotation * other.translation_mm + translation_mm};
}

RigidPose small_motion(const Vec3& turn_rad, const Vec3& shift_mm, const Vec3& centre_mm) {
  const double angle_rad = turn_rad.norm();
  RigidPose pose;
  if (angle_rad > 0.0) pose.rotation = Eigen::AngleAxisd(angle_rad, turn_rad / angle_rad).toRotationMatrix();
  pose.translation_mm = centre_mm - pose.rotation * centre_mm + shift_mm;
  return pose;
}

RigidPose pose_of_quaternion(const std::array<double, 4>& wxyz, const Vec3& translation_mm) {
  const Eigen::Quaterniond quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!(quaternion.norm() > 1e-6) || !std::isfinite(quaternion.norm())) {
    fail("expected a quaternion that is not zero, found ", wxyz[0], ", ", wxyz[1], ", ", wxyz[2], ", ", wxyz[3]);
  }
  return {quaternion.normalized().toRotationMatrix(), translation_mm};
}

RigidPose checked_pose(const RigidPose& pose, std::string_view what) {
  constexpr double kMaxOff = 1e-3;
  constexpr double kFarMm = 1e5;
  if (!(pose.translation_mm.cwiseAbs().maxCoeff() <= kFarMm)) {
    fail(what, ": expected a shift of up to ", kFarMm, " mm, found ", pose.translation_mm.transpose());
  }
  const Mat3 square = pose.rotation.transpose() * pose.rotation;
  if (!((square - Mat3::Identity()).cwiseAbs().maxCoeff() <= kMaxOff) || !(pose.rotation.determinant() > 0.0)) {
    fail(what, ": expected a rotation (columns at right angles, of length 1, right-handed), found none");
  }
  const Eigen::JacobiSVD<Mat3> svd(pose.rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU() * svd.matrixV().transpose(), pose.translation_mm};
}

double angle_between_rad(const RigidPose& a, const RigidPose& b) {
  const Eigen::Quaterniond turn(Mat3(a.rotation.transpose() * b.rotation));
  return 2.0 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
}

RigidPose fit_pose(std::span<const Vec3> from_mm, std::span<const Vec3> to_mm, std::span<const double> weights) {
  constexpr std::size_t kFewest = 3;
  if (from_mm.size() != to_mm.size() || from_mm.size() < kFewest ||
      (!weights.empty() && weights.size() != from_mm.size())) {
    fail("fitting a pose: expected 3 pairs of points or more, found ", from_mm.size(), " and ", to_mm.size());
  }
  const auto weight = [&](std::size_t n) { return weights.empty() ? 1.0 : weights[n]; };
  double total = 0.0;
  Vec3 from_middle = Vec3::Zero(), to_middle = Vec3::Zero();
  for (std::size_t n = 0; n < from_mm.size(); ++n) {
    total += weight(n);
    from_middle += weight(n) * from_mm[n];
    to_middle += weight(n) * to_mm[n];
  }
  if (!(total > 0.0)) fail("fitting a pose: expected a weight above 0, found none");
  from_middle /= total;
  to_middle /= total;
  Mat3 products = Mat3::Zero();
  for (std::size_t n = 0; n < from_mm.size(); ++n) {
    products += weight(n) * (from_mm[n] - from_middle) * (to_mm[n] - to_middle).transpose();
  }
  // Horn's matrix, whose eigenvector of the largest eigenvalue is the quaternion.
  Eigen::Matrix4d horn;
  const Vec3 skew(products(1, 2) - products(2, 1), products(2, 0) - products(0, 2), products(0, 1) - products(1, 0));
  horn(0, 0) = products.trace();
  horn.block<1, 3>(0, 1) = skew.transpose();
  horn.block<3, 1>(1, 0) = skew;
  horn.block<3, 3>(1, 1) = products + products.transpose() - products.trace() * Mat3::Identity();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(horn);
  const Eigen::Vector4d best = solver.eigenvectors().col(3);
  RigidPose pose;
  pose.rotation = Eigen::Quaterniond(best[0], best[1], best[2], best[3]).normalized().toRotationMatrix();
  pose.translation_mm = to_middle - pose.rotation * from_middle;
  return pose;
}

}  // namespace spinaltap
