#include "core/engine/detail/nearest_point.h"

namespace spinaltap::detail {
namespace {

/// Beyond all that is drilled: 10 m.
constexpr double kFarMm = 1e4;

}  // namespace

NearestPoint::NearestPoint(const PointApproach& approach, double z_mm) noexcept : approach_(approach) {
  const AxisLine& line = approach.line;
  x_mm_ = line.x_mm + z_mm * line.x_slope;
  y_mm_ = line.y_mm + z_mm * line.y_slope;
  back_mm_ = line.back_mm + z_mm * line.back_slope;
  size_mm_ = approach.radius_mm;
  squeeze_ = approach.along;
  per_squeeze_ = 1.0 / approach.along;
  surely_free_mm_ = approach.reach_mm;
  if (approach.is_tight) {
    const double cone_mm = approach.offset_mm + approach.slope * back_mm_;
    ellipse_ = &approach.cylinder;
    if (cone_mm < approach.radius_mm) {
      ellipse_ = &approach.cone;
      surely_free_mm_ =
          (approach.reach_mm + approach.cone_spare_mm + approach.slope * approach.bit.back_mm()) * ellipse_->growth;
      size_mm_ = ellipse_->gain * cone_mm;
      x_mm_ -= ellipse_->shift_x * cone_mm;
      y_mm_ -= ellipse_->shift_y * cone_mm;
    }
    squeeze_ = ellipse_->squeeze;
    per_squeeze_ = ellipse_->per_squeeze;
    surely_free_mm_ = std::min(surely_free_mm_, max_passed_mm());
  } else {
    // Of other bits, what is further along the axis than a certificate is long does not matter to this disc.
    const auto [first_mm, last_mm] = backs_mm(approach.spread_mm);
    const double widest_mm = approach.bit.profile().widest_mm(first_mm - kLongestMm, last_mm + kLongestMm);
    size_mm_ = widest_mm < 0.0 ? -kFarMm : widest_mm;
  }
  off_axis_mm_ = std::sqrt(x_mm_ * x_mm_ + y_mm_ * y_mm_);
  nearer_mm_ = ellipse_ == &approach.cone ? approach.cone_nearer_mm : approach.cylinder_nearer_mm;
  touched_mm_ = touched_off_centre_mm() * per_squeeze_;
}

std::pair<double, double> NearestPoint::backs_mm(double spread_mm) const noexcept {
  return {back_mm_ - spread_mm - approach_.bit.forth_mm(), back_mm_ + spread_mm + approach_.bit.back_mm()};
}

double NearestPoint::max_passed_mm() const noexcept {
  const PointApproach& a = approach_;
  const SweptBit& bit = a.bit;
  // A turning way takes what a straight one before it left within the thicker skin, wherever the bit goes then.
  if (bit.edge_mm() > 0.0) return HUGE_VAL;
  // How far off the axis, at the end, points that are passed lie at most, and so how far along it from the middle.
  double off_axis_mm = a.radius_mm + a.reach_mm;
  if (ellipse_ == &a.cone) {
    const double cone_mm = std::max(0.0, a.offset_mm + a.slope * (back_mm_ + bit.back_mm()));
    off_axis_mm = std::min(off_axis_mm, (cone_mm + a.reach_mm) * a.cone_widens);
  }
  const auto [first_mm, last_mm] = backs_mm(a.tilt * off_axis_mm + a.off_plane_back_mm);
  if (ellipse_ == &a.cylinder) {
    return first_mm > a.neck_mm && last_mm < bit.profile().length_mm() ? a.cylinder_passed_mm : HUGE_VAL;
  }
  if (!(first_mm > 0.0 && last_mm < a.neck_mm)) return HUGE_VAL;
  return a.passed_mm(a.offset_mm + a.slope * first_mm, a.cone, a.cone_spare_mm);
}

}  // namespace spinaltap::detail
