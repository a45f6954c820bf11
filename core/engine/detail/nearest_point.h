#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/geometry.h"
#include "core/engine/detail/disc_certificates.h"
#include "core/tool/swept_bit.h"

namespace spinaltap {

/// The ellipse in which a disc's plane meets a cone that widens by `slope` back along its axis; a cylinder has slope 0.
///
/// With c the cone's radius where the axis meets the plane, v from there, t the sine of the tilt, u along it, q across:
///   off-axis² = q² + u² - t² u² <= (c - slope t u)²   is   q² + squeeze² (u + shift c)² <= (gain c)².
/// The form sqrt(q² + squeeze² (u + shift c)²) - gain c changes no faster than the axis moves in the plane, plus
/// growth times c.
struct DiscEllipse {
  double squeeze_squared, squeeze, per_squeeze, gain, shift_x, shift_y, flatness, root_flatness;
  double growth;  ///< how much further the ellipse reaches, at most, where c is larger by 1

  DiscEllipse(const Vec3& axis, double slope) {
    const double t2 = axis.x() * axis.x() + axis.y() * axis.y();
    flatness = 1.0 + slope * slope;
    root_flatness = std::sqrt(flatness);
    // Below the smallest, the plane meets the cone in no ellipse worth the name; see is_ellipse().
    squeeze_squared = std::max(kSmallest, 1.0 - flatness * t2);
    squeeze = std::sqrt(squeeze_squared);
    per_squeeze = 1.0 / squeeze;
    gain = std::sqrt(1.0 + slope * slope * t2 / squeeze_squared);
    shift_x = slope * axis.x() / squeeze_squared;
    shift_y = slope * axis.y() / squeeze_squared;
    growth = gain + std::sqrt(shift_x * shift_x + shift_y * shift_y);
  }

  /// For the rounding of distances that are compared.
  static constexpr double kNotQuite = 1.0 - 1e-7;
  bool is_ellipse() const { return squeeze_squared > kSmallest; }
  /// sqrt(q² + squeeze² u²) of a place relative to the ellipse's centre.
  double off_centre(double x, double y, const Vec3& axis) const {
    const double along = x * axis.x() + y * axis.y();
    return std::sqrt(std::max(0.0, x * x + y * y - flatness * along * along));
  }

  /// On a ring around the path, of radius r, points are ever further off centre towards the side away from the
  /// ellipse's centre c, from a point p on whose cross product with c is at least this.
  ///
  /// With T = 1 - squeeze², and p and a further point q at angles a < b from c, off-centre² grows from p to q by
  ///   2 r |c| (cos a - cos b) - T ((q - p) . u) ((q + p - 2 c) . u)
  ///     >= 4 r sin((b - a) / 2) (|c| sin((a + b) / 2) - T (r + |c|)),
  /// u being the direction of the tilt, and that sine is at least sin(a) / 2 up to b = half a turn.
  double far_round(double ring_mm, double off_axis_mm) const {
    return 2.0 * (1.0 - squeeze_squared) * (ring_mm + off_axis_mm) * ring_mm;
  }

 private:
  static constexpr double kSmallest = 0.0625;
};

}  // namespace spinaltap

namespace spinaltap::detail {

/// No certificate is longer: to look for a nearest point further out costs more than to look again.
constexpr double kLongestMm = 0.5;
/// Rounding and the skin of a straight way, with room; that of a turning one is among what SweptBit says. Of a cone:
/// across its wall.
constexpr double kSpareMm = 1e-5;
/// What certificates are shorter by than the gap: skin, float, and the walk's shortened reach.
constexpr double kMarginMm = 5e-6;

/// What a bit at the end of its way is to all discs.
struct PointApproach {
  const SweptBit& bit;
  Vec3 axis;
  double along;  ///< |cosine| of the tilt
  double sine;
  double radius_mm, slope, offset_mm;  ///< of the bounding cylinder and cone
  double out_of_plane_mm;              ///< how far points lie out of their disc's plane, at most
  double reach_mm;                     ///< across the axis, by the way alone
  DiscEllipse cylinder, cone;
  double cone_spare_mm;       ///< kSpareMm across the axis
  bool is_tight;              ///< cylinder and cone are the bit, and both meet discs in ellipses
  double spread_mm;           ///< how far along the axis, to both sides, points of a disc within reach lie
  double tilt;                ///< how far along the axis points of a disc lie for each mm off it, at most
  double off_plane_back_mm;   ///< and by how much more, out of their plane
  double cone_widens;         ///< by how much a tilted cone's points are further off its axis; infinite for a steep one
  double neck_mm;             ///< where the cone ends, back from the tip
  double cylinder_passed_mm;  ///< passed_mm() of the cylinder: most discs ask for it
  double cylinder_nearer_mm, cone_nearer_mm;  ///< see nearer_mm()
  AxisLine line;

  PointApproach(const SweptBit& swept, double points_out_of_plane_mm)
      : bit(swept),
        axis(swept.to().axis),
        along(std::abs(axis.z())),
        sine(std::sqrt(axis.x() * axis.x() + axis.y() * axis.y())),
        radius_mm(swept.profile().radius_mm()),
        slope(swept.profile().cone_slope()),
        offset_mm(swept.profile().cone_offset_mm()),
        out_of_plane_mm(points_out_of_plane_mm),
        reach_mm(swept.across_mm() + points_out_of_plane_mm + kSpareMm),
        cylinder(axis, 0.0),
        cone(axis, slope),
        cone_spare_mm(kSpareMm * cone.root_flatness),
        is_tight(swept.profile().is_cone_and_cylinder() && cylinder.is_ellipse() && cone.is_ellipse()) {
    const Vec3& tip_mm = swept.to().tip_mm;
    line.x_slope = axis.x() / axis.z();
    line.y_slope = axis.y() / axis.z();
    line.x_mm = tip_mm.x() - tip_mm.z() * line.x_slope;
    line.y_mm = tip_mm.y() - tip_mm.z() * line.y_slope;
    line.back_mm = tip_mm.z() / axis.z();
    line.back_slope = -1.0 / axis.z();
    spread_mm = (sine * (radius_mm + kLongestMm + reach_mm) + reach_mm) / along;
    tilt = sine / along;
    off_plane_back_mm = (out_of_plane_mm + kSpareMm) / along;
    cone_widens = slope * tilt < 0.5 ? 1.0 / (1.0 - slope * tilt) : HUGE_VAL;
    neck_mm = (radius_mm - offset_mm) / slope;
    cylinder_passed_mm = passed_mm(radius_mm, cylinder, kSpareMm);
    cylinder_nearer_mm = nearer_mm(0.0, cylinder);
    cone_nearer_mm = nearer_mm(slope, cone);
  }

  /// See NearestPoint::max_passed_mm(): of a disc that meets one bound all the way, no narrower than this.
  double passed_mm(double min_radius_mm, const DiscEllipse& ellipse, double spare_mm) const {
    const double across_mm = bit.across_mm();
    if (!(min_radius_mm > 5.0 * across_mm)) return HUGE_VAL;
    const double bend_mm = across_mm * across_mm / (2.0 * (min_radius_mm - across_mm));
    return (bend_mm + spare_mm) * ellipse.growth;
  }

  /// How much nearer to a bound that widens by `widens` a point out of the disc's plane may be than its foot there: in
  /// its own plane the middle lies elsewhere, and the bound is of another size.
  double nearer_mm(double widens, const DiscEllipse& ellipse) const {
    return out_of_plane_mm * (tilt + widens * ellipse.growth / along);
  }
};

/// A bound of the bit in one disc, and the nearest occupied point to it so far.
class NearestPoint {
 public:
  /// Of the disc at z along the path.
  NearestPoint(const PointApproach& approach, double z_mm) noexcept;

  /// The bound's middle in the disc's plane.
  double x_mm() const { return x_mm_; }
  double y_mm() const { return y_mm_; }
  double off_axis_mm() const { return off_axis_mm_; }
  double turns() const { return std::atan2(y_mm_, x_mm_) / (2.0 * std::numbers::pi); }
  /// Points further from the middle are not reached by the step.
  double touched_mm() const { return touched_mm_; }
  /// The same, of points as far off the middle as ellipse() counts it.
  double touched_off_centre_mm() const { return size_mm_ + surely_free_mm_ + nearer_mm_; }
  FloatEllipse ellipse() const {
    const double root = shape().root_flatness;
    return {static_cast<float>(root * approach_.axis.x()), static_cast<float>(root * approach_.axis.y()),
            static_cast<float>(squeeze_ * squeeze_)};
  }
  /// Whether all that may meet the disc is the cylinder: it stays so while the bit goes on.
  bool is_behind_cone() const { return ellipse_ == &approach_.cylinder; }
  /// Points further from the middle are neither reached nor nearer to the bound than the nearest so far.
  double reach_mm() const {
    // Points as near as the best, but for rounding, are not looked at: often a whole ring lies equally far.
    return std::max(touched_mm_, (best_mm_ + nearer_mm_ + size_mm_) * DiscEllipse::kNotQuite * per_squeeze_);
  }

  /// There is, or may be, an occupied point at this distance from the middle, and none nearer among those it speaks
  /// for.
  void add_distance(double middle_mm) { improve(squeeze_ * middle_mm - size_mm_ - nearer_mm_); }
  /// The same, of a point this far off the middle as ellipse() counts it.
  void add_off_centre(double off_centre_mm) { improve(off_centre_mm - size_mm_ - nearer_mm_); }
  /// Point p in the disc's plane lives, or may, and speaks for all beyond it, counterclockwise around its ring or
  /// clockwise.
  void add_end(double ring_mm, bool is_counterclockwise, const Vec3& p) {
    const double turned = x_mm_ * p.y() - y_mm_ * p.x();
    const double x = p.x() - x_mm_, y = p.y() - y_mm_;
    if ((is_counterclockwise ? turned : -turned) > shape().far_round(ring_mm, off_axis_mm_)) {
      add_off_centre(shape().off_centre(x, y, approach_.axis));
    } else {
      add_distance(std::sqrt(x * x + y * y));
    }
  }

  /// Whether the step removes p; where not, it may be the nearest.
  bool removes(const Vec3& p, double z_mm) noexcept;

  double free_mm() const {
    if (ellipse_ == &approach_.cylinder) return best_mm_ - kMarginMm;
    return best_mm_ - kMarginMm - (ellipse_ == &approach_.cone ? approach_.cone_spare_mm : kSpareMm);
  }
  double back_share() const {
    if (ellipse_ == nullptr) return 1.0;
    return ellipse_ == &approach_.cone ? approach_.slope * ellipse_->growth : 0.0;
  }

 private:
  /// How far back from the tip points of the disc lie, all the way, that lie so far along the axis from the middle.
  std::pair<double, double> backs_mm(double spread_mm) const noexcept;

  /// How far from the bound a point may lie that lived at the step's start and was passed on the way; infinite where
  /// that is not known.
  ///
  /// Where only the cone, or only the cylinder, is met all the way, the distance f to it along the chord is convex,
  /// with f'' of at most across² / radius. At the step's start f was above 0, or the point were dead. To be below 0 on
  /// the way it must fall first, so at the end it is at most f'' / 2: nanometres for an operator's micrometres.
  double max_passed_mm() const noexcept;

  void improve(double distance_mm) {
    if (distance_mm < best_mm_) best_mm_ = distance_mm;
  }

  const DiscEllipse& shape() const { return ellipse_ != nullptr ? *ellipse_ : approach_.cylinder; }

  const PointApproach& approach_;
  const DiscEllipse* ellipse_ = nullptr;  ///< of the bound that says most here; none for a bit that is neither
  double x_mm_, y_mm_, back_mm_;
  double off_axis_mm_;
  double size_mm_;  ///< of the bound, from its middle
  double squeeze_;  ///< distances from the bound grow at least by this with those from the middle
  double per_squeeze_;
  double surely_free_mm_;  ///< points further than this from the bound survive
  double nearer_mm_;       ///< than they seem in the disc's plane, at most
  double touched_mm_;
  double best_mm_ = kLongestMm;  ///< from the bound
};

// In sight of the engine's innermost loop.
inline bool NearestPoint::removes(const Vec3& p, double z_mm) noexcept {
  const PointApproach& a = approach_;
  const Vec3 from_tip = p - a.bit.to().tip_mm;
  const double back_mm = -from_tip.dot(a.axis);
  const double off_axis_squared = std::max(0.0, from_tip.squaredNorm() - back_mm * back_mm);
  const BitProfile& profile = a.bit.profile();
  if (profile.contains_inlined(back_mm, off_axis_squared)) return true;
  double from_bound_mm = 0.0;
  if (ellipse_ != nullptr) {
    // A point out of the disc's plane lies in another, where the middle is elsewhere and the cone of another size.
    const double out_mm = p.z() - z_mm;
    double x = p.x() - x_mm_ - out_mm * a.line.x_slope;
    double y = p.y() - y_mm_ - out_mm * a.line.y_slope;
    double size_mm = size_mm_;
    if (ellipse_ == &a.cone && out_mm != 0.0) {
      const double wider_mm = a.slope * out_mm * a.line.back_slope;
      x += ellipse_->shift_x * wider_mm;
      y += ellipse_->shift_y * wider_mm;
      size_mm += ellipse_->gain * wider_mm;
    }
    from_bound_mm = ellipse_->off_centre(x, y, a.axis) - size_mm;
    if (from_bound_mm <= surely_free_mm_ && a.bit.contains_inlined(p)) return true;
  } else {
    if (a.bit.contains_inlined(p)) return true;
    const double off_axis_mm = std::sqrt(off_axis_squared);
    if (off_axis_mm - size_mm_ >= best_mm_) return false;
    from_bound_mm = profile.distance_mm(back_mm, off_axis_mm);
  }
  improve(from_bound_mm);
  return false;
}

}  // namespace spinaltap::detail
