#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/geometry.h"

namespace spinaltap {

/// The ellipse in which a disc's plane meets a cone that widens by `slope` back along its axis; a cylinder has slope 0.
///
/// With c the cone's radius where the axis meets the plane, v from there, t the sine of the tilt, u along it, q across:
///   off-axis² = q² + u² - t² u² <= (c - slope t u)²   is   q² + squeeze² (u + shift c)² <= (gain c)².
/// The form sqrt(q² + squeeze² (u + shift c)²) - gain c changes no faster than the axis moves in the plane, plus
/// growth times c.
struct DiscEllipse {
  double squeeze_squared, squeeze, gain, shift_x, shift_y, flatness;

  DiscEllipse(const Vec3& axis, double slope) {
    const double t2 = axis.x() * axis.x() + axis.y() * axis.y();
    flatness = 1.0 + slope * slope;
    // Below the smallest, the plane meets the cone in no ellipse worth the name; see is_ellipse().
    squeeze_squared = std::max(kSmallest, 1.0 - flatness * t2);
    squeeze = std::sqrt(squeeze_squared);
    gain = std::sqrt(1.0 + slope * slope * t2 / squeeze_squared);
    shift_x = slope * axis.x() / squeeze_squared;
    shift_y = slope * axis.y() / squeeze_squared;
  }

  bool is_ellipse() const { return squeeze_squared > kSmallest; }
  /// How much further the ellipse reaches, at most, where c is larger by 1.
  double growth() const { return gain + std::sqrt(shift_x * shift_x + shift_y * shift_y); }
  /// sqrt(q² + squeeze² u²) of a place relative to the ellipse's centre.
  double off_centre(double x, double y, const Vec3& axis) const {
    const double along = x * axis.x() + y * axis.y();
    return std::sqrt(std::max(0.0, x * x + y * y - flatness * along * along));
  }

 private:
  static constexpr double kSmallest = 0.0625;
};

}  // namespace spinaltap
