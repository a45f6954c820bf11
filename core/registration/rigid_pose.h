#pragma once

#include <array>
#include <span>
#include <string_view>

#include "core/base/geometry.h"

namespace spinaltap {

/// A rotation and a shift: where things of one frame lie in another. `ct_from_patient` takes what a tracker measured on
/// the patient into the CT (patient LPS); lengths in mm.
struct RigidPose {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation_mm = Vec3::Zero();

  Vec3 apply(const Vec3& p_mm) const;
  RigidPose inverse() const;
  /// First `other`, then this.
  RigidPose after(const RigidPose& other) const;
};

/// Turned by a rotation vector (axis times angle, rad) about `centre_mm`, then shifted.
RigidPose small_motion(const Vec3& turn_rad, const Vec3& shift_mm, const Vec3& centre_mm);

/// From a quaternion (w, x, y, z) of any length that is not zero.
RigidPose pose_of_quaternion(const std::array<double, 4>& wxyz, const Vec3& translation_mm);

/// Throws Error, which calls it `what`, where the rotation is none to 1e-3 or a number is not finite, and gives the
/// nearest rotation otherwise: files round.
RigidPose checked_pose(const RigidPose& pose, std::string_view what);

/// The angle between two poses' rotations, rad.
double angle_between_rad(const RigidPose& a, const RigidPose& b);

/// The pose that takes `from_mm` nearest to `to_mm` in least squares, each pair with its weight (0 or more; none: all
/// alike): the quaternion of Horn, "Closed-form solution of absolute orientation using unit quaternions", J. Opt. Soc.
/// Am. A 1987. Never a reflection. Throws Error on other than equally many points, and fewer than 3 of them.
RigidPose fit_pose(std::span<const Vec3> from_mm, std::span<const Vec3> to_mm, std::span<const double> weights = {});

}  // namespace spinaltap
