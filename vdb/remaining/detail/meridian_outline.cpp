#include "vdb/remaining/detail/meridian_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spinaltap::detail {
namespace {

/// Slopes of a piece's outline at both ends, mm per mm.
double slope_at(const ProfilePiece& piece, double back_mm, double radius_mm) {
  if (piece.ball_radius_mm == 0.0) {
    return (piece.end_radius_mm - piece.begin_radius_mm) / (piece.end_mm - piece.begin_mm);
  }
  const double from_centre_mm = piece.ball_centre_mm - back_mm;
  if (radius_mm > 0.0) return from_centre_mm / radius_mm;
  return std::copysign(std::numeric_limits<double>::infinity(), from_centre_mm);
}

/// Whether two pieces, the second behind the first, are one convex body.
bool bulges(const ProfilePiece& first, const ProfilePiece& second) {
  constexpr double kSameMm = 1e-9;
  if (std::abs(first.end_radius_mm - second.begin_radius_mm) > kSameMm) return false;
  return slope_at(second, second.begin_mm, second.begin_radius_mm) <=
         slope_at(first, first.end_mm, first.end_radius_mm) + kSameMm;
}

}  // namespace

void MeridianOutline::add_line(double back_mm, double off_mm, double to_back_mm, double to_off_mm) {
  const double along_back_mm = to_back_mm - back_mm;
  const double along_off_mm = to_off_mm - off_mm;
  const double length_mm = std::hypot(along_back_mm, along_off_mm);
  if (!(length_mm > 0.0)) return;
  lines_[line_count_++] = {back_mm,
                           off_mm,
                           along_back_mm,
                           along_off_mm,
                           1.0 / (length_mm * length_mm),
                           -along_off_mm / length_mm,
                           along_back_mm / length_mm};
}

MeridianOutline::MeridianOutline(std::span<const ProfilePiece> pieces) {
  double before_mm = 0.0;
  for (const ProfilePiece& piece : pieces) {
    pieces_[piece_count_++] = piece;
    add_line(piece.begin_mm, before_mm, piece.begin_mm, piece.begin_radius_mm);
    if (piece.ball_radius_mm > 0.0) {
      arcs_[arc_count_++] = {piece.ball_centre_mm, piece.ball_radius_mm,  piece.begin_mm,
                             piece.end_mm,         piece.begin_radius_mm, piece.end_radius_mm};
    } else {
      add_line(piece.begin_mm, piece.begin_radius_mm, piece.end_mm, piece.end_radius_mm);
    }
    before_mm = piece.end_radius_mm;
  }
  add_line(pieces.back().end_mm, before_mm, pieces.back().end_mm, 0.0);
}

MeridianSample MeridianOutline::at(double back_mm, double off_mm) const noexcept {
  double min_mm2 = std::numeric_limits<double>::infinity();
  double from_back_mm = 0.0;  // from the nearest point of the outline
  double from_off_mm = 0.0;
  double out_back = 0.0;
  double out_off = 1.0;
  const auto take = [&](double nearest_back_mm, double nearest_off_mm, double normal_back, double normal_off) {
    const double b = back_mm - nearest_back_mm;
    const double o = off_mm - nearest_off_mm;
    const double squared = b * b + o * o;
    if (!(squared < min_mm2)) return;
    min_mm2 = squared;
    from_back_mm = b;
    from_off_mm = o;
    out_back = normal_back;
    out_off = normal_off;
  };
  for (std::size_t n = 0; n < line_count_; ++n) {
    const Line& line = lines_[n];
    const double t =
        std::clamp(((back_mm - line.back_mm) * line.along_back_mm + (off_mm - line.off_mm) * line.along_off_mm) *
                       line.per_length_squared,
                   0.0, 1.0);
    take(line.back_mm + t * line.along_back_mm, line.off_mm + t * line.along_off_mm, line.out_back, line.out_off);
  }
  for (std::size_t n = 0; n < arc_count_; ++n) {
    const Arc& arc = arcs_[n];
    const double b = back_mm - arc.centre_mm;
    const double from_centre_mm = std::sqrt(b * b + off_mm * off_mm);
    // From the centre itself all of the ball is as far; forward is as good as any.
    const double out_b = from_centre_mm > 0.0 ? b / from_centre_mm : -1.0;
    const double out_o = from_centre_mm > 0.0 ? off_mm / from_centre_mm : 0.0;
    const double meets_mm = arc.centre_mm + arc.radius_mm * out_b;
    if (meets_mm >= arc.begin_mm && meets_mm <= arc.end_mm) {
      take(meets_mm, arc.radius_mm * out_o, out_b, out_o);
    } else {
      take(arc.begin_mm, arc.begin_off_mm, -1.0, 0.0);
      take(arc.end_mm, arc.end_off_mm, 1.0, 0.0);
    }
  }
  const bool is_inside = contains(back_mm, off_mm * off_mm);
  const double distance_mm = std::sqrt(min_mm2);
  constexpr double kOnOutlineMm = 1e-9;
  if (distance_mm < kOnOutlineMm) return {is_inside ? -distance_mm : distance_mm, out_back, out_off};
  const double per_mm = (is_inside ? -1.0 : 1.0) / distance_mm;
  return {is_inside ? -distance_mm : distance_mm, from_back_mm * per_mm, from_off_mm * per_mm};
}

double MeridianOutline::distance_mm(double back_mm, double off_mm) const noexcept {
  if (arc_count_ > 0) return at(back_mm, off_mm).distance_mm;
  double min_mm2 = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < line_count_; ++n) {
    const Line& line = lines_[n];
    const double b = back_mm - line.back_mm;
    const double o = off_mm - line.off_mm;
    const double along = b * line.along_back_mm + o * line.along_off_mm;
    const double t = std::min(1.0, std::max(0.0, along * line.per_length_squared));
    const double across_b = b - t * line.along_back_mm;
    const double across_o = o - t * line.along_off_mm;
    min_mm2 = std::min(min_mm2, across_b * across_b + across_o * across_o);
  }
  const double distance_mm = std::sqrt(min_mm2);
  return contains(back_mm, off_mm * off_mm) ? -distance_mm : distance_mm;
}

bool MeridianOutline::contains(double back_mm, double off_squared_mm2) const noexcept {
  for (std::size_t n = 0; n < piece_count_; ++n) {
    const ProfilePiece& piece = pieces_[n];
    if (back_mm >= piece.begin_mm && back_mm <= piece.end_mm && off_squared_mm2 <= piece.radius_squared_mm2(back_mm)) {
      return true;
    }
  }
  return false;
}

BitOutline::BitOutline(const BitProfile& profile)
    : whole_(profile.pieces()), length_mm_(profile.length_mm()), radius_mm_(profile.radius_mm()) {
  const std::span<const ProfilePiece> pieces = profile.pieces();
  std::size_t begin = 0;
  for (std::size_t n = 1; n <= pieces.size(); ++n) {
    if (n < pieces.size() && bulges(pieces[n - 1], pieces[n])) continue;
    parts_.emplace_back(pieces.subspan(begin, n - begin));
    begin = n;
  }
  const ProfilePiece& last = pieces.back();
  const bool is_cylinder =
      last.ball_radius_mm == 0.0 && last.begin_radius_mm == last.end_radius_mm && last.end_radius_mm == radius_mm_;
  cylinder_begin_mm_ = is_cylinder ? last.begin_mm : last.end_mm;
}

BitOutline::BitOutline(const PlateBox& plate)
    : box_(plate),
      length_mm_(plate.length_mm()),
      radius_mm_(plate.high_mm().head<2>().norm()),
      cylinder_begin_mm_(plate.length_mm()) {}

}  // namespace spinaltap::detail
