#pragma once

#include <string>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap {

/// How a pose errs: a small turn about `centre_mm` (a rotation vector, rad) and a shift (mm), both normal with mean 0,
/// as the blocks of their 6 by 6 covariance. Everything in the frame that the pose leads to: the CT's, patient LPS, mm.
struct PoseCovariance {
  Vec3 centre_mm = Vec3::Zero();
  Mat3 turn_rad2 = Mat3::Zero();   ///< of the turn
  Mat3 turn_shift = Mat3::Zero();  ///< of the turn (rows, rad) with the shift (columns, mm)
  Mat3 shift_mm2 = Mat3::Zero();   ///< of the shift
};

/// Covariance (mm²) of the target registration error at a place: turn and shift together.
Mat3 target_covariance_mm2(const PoseCovariance& covariance, const Vec3& p_mm);
/// Its root mean square, mm: the TRE of Fitzpatrick & West.
double target_error_mm(const PoseCovariance& covariance, const Vec3& p_mm);
/// Its standard deviation along a direction (any length but 0), mm.
double target_error_along_mm(const PoseCovariance& covariance, const Vec3& p_mm, const Vec3& direction);

/// A motion that the measured points hold badly.
struct WeakMotion {
  bool is_turn = false;
  double size = 0.0;          ///< standard deviation: mm of a slide, degrees of a turn
  double at_points_mm = 0.0;  ///< root mean square of what it moves the measured points by
  Vec3 axis = Vec3::UnitX();  ///< unit: along which it slides, or about which it turns
};
/// The motions whose deviation, at points that lie `reach_mm` (root mean square) from the centre, is above `limit_mm`,
/// worst first: principal axes of the covariance, turns measured by what they do there.
std::vector<WeakMotion> weak_motions(const PoseCovariance& covariance, double reach_mm, double limit_mm);

/// "may slide 2.1 mm along (0.02, -0.10, 0.99), mostly foot to head"
std::string in_words(const WeakMotion& motion);

/// Throws Error where it is no covariance: not finite, not symmetric to 1e-6, or with a negative variance.
void check_covariance(const PoseCovariance& covariance);

/// A draw of (turn, shift) from six standard normal numbers.
struct PoseError {
  Vec3 turn_rad = Vec3::Zero();
  Vec3 shift_mm = Vec3::Zero();
};
PoseError pose_error_of(const PoseCovariance& covariance, const Vec3& normals_a, const Vec3& normals_b);

}  // namespace spinaltap
