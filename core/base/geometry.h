#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <numbers>
#include <span>

namespace spinaltap {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
/// Axis-aligned box; lengths are in the unit of its points (mm in patient space).
using Box3 = Eigen::AlignedBox3d;

/// One degree, rad.
inline constexpr double kDegree = std::numbers::pi / 180.0;

/// Any unit vector at right angles to `axis` (unit). The same axis always gives the same vector.
Vec3 any_perpendicular(const Vec3& axis);

/// The angle from one direction to another, 0 to pi, rad; neither need be a unit vector. By its sine and its cosine:
/// the cosine alone says little of small angles.
double angle_between_rad(const Vec3& a, const Vec3& b);

/// The smallest box around points; empty without any.
Box3 bounds_of(std::span<const Vec3> points);

/// A range of numbers, both ends in it.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

}  // namespace spinaltap
