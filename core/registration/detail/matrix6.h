#pragma once

#include "core/registration/pose_covariance.h"

namespace spinaltap::detail {

/// Of turn and shift, in this order.
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

Matrix6 whole_matrix(const PoseCovariance& covariance);
PoseCovariance covariance_of(const Matrix6& whole, const Vec3& centre_mm);

}  // namespace spinaltap::detail
