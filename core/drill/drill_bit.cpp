#include "core/drill/drill_bit.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {
namespace {

/// Distance from q to the segment a-b, in the plane.
double segment_distance(const Eigen::Vector2d& q, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double t = std::clamp((q - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (q - a - t * along).norm();
}

}  // namespace

void check_bit(const DrillBit& bit) {
  const auto above_zero = [](double length_mm, const char* what) {
    if (!(length_mm > 0.0) || !std::isfinite(length_mm)) {
      fail("drill bit: expected a ", what, " above 0 mm, found ", length_mm, " mm");
    }
  };
  above_zero(bit.diameter_mm, "diameter");
  above_zero(bit.length_mm, "length");
  above_zero(bit.tip_length_mm, "tip length");
  if (bit.tip_length_mm > bit.length_mm) {
    fail("drill bit: expected a tip no longer than the bit, found ", bit.tip_length_mm, " mm of ", bit.length_mm,
         " mm");
  }
}

bool bit_contains(const DrillBit& bit, const Pose& pose, const Vec3& p) {
  const double cylinder_share = (bit.length_mm - bit.tip_length_mm) / bit.length_mm;
  const Vec3 base_mm = pose.tip_mm - bit.length_mm * pose.axis;
  const Vec3 from_base_mm = p - base_mm;
  const double along_mm = from_base_mm.dot(pose.axis);
  const double alpha = along_mm / bit.length_mm;
  if (alpha < 0.0 || alpha > 1.0) return false;
  const double off_axis_squared = (along_mm * pose.axis - from_base_mm).squaredNorm();
  double allowed_mm = bit.radius_mm();
  if (alpha > cylinder_share) allowed_mm *= (1.0 - alpha) * bit.length_mm / bit.tip_length_mm;
  return off_axis_squared <= allowed_mm * allowed_mm;
}

double bit_distance_mm(const DrillBit& bit, const Pose& pose, const Vec3& p) {
  // The bit is a body of revolution: its distance is that to its outline in the half plane (back from the tip, off
  // axis).
  const Vec3 from_tip_mm = p - pose.tip_mm;
  const double back_mm = -from_tip_mm.dot(pose.axis);
  const double off_axis_mm = (from_tip_mm + back_mm * pose.axis).norm();
  const Eigen::Vector2d q(back_mm, off_axis_mm);
  const Eigen::Vector2d tip(0.0, 0.0);
  const Eigen::Vector2d shoulder(bit.tip_length_mm, bit.radius_mm());
  const Eigen::Vector2d base_rim(bit.length_mm, bit.radius_mm());
  const Eigen::Vector2d base_centre(bit.length_mm, 0.0);
  const double to_cone_mm = segment_distance(q, tip, shoulder);
  const double to_wall_mm = bit.length_mm > bit.tip_length_mm ? segment_distance(q, shoulder, base_rim) : to_cone_mm;
  const double to_base_mm = segment_distance(q, base_rim, base_centre);
  const double distance_mm = std::min({to_cone_mm, to_wall_mm, to_base_mm});
  const bool inside = back_mm >= 0.0 && back_mm <= bit.length_mm && off_axis_mm <= bit.radius_mm() &&
                      off_axis_mm * bit.tip_length_mm <= back_mm * bit.radius_mm();
  return inside ? -distance_mm : distance_mm;
}

}  // namespace spinaltap
