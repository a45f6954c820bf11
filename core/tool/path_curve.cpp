#include "core/tool/path_curve.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"
#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

/// Second derivatives of the natural cubic spline through `places` at `knots`: Thomas's algorithm for its tridiagonal
/// system, whose diagonal dominates.
std::vector<Vec3> second_derivatives(const std::vector<Vec3>& places, const std::vector<double>& knots) {
  const std::size_t count = places.size();
  std::vector<Vec3> second(count, Vec3::Zero());
  std::vector<double> upper(count, 0.0);
  for (std::size_t n = 1; n + 1 < count; ++n) {
    const double before = knots[n] - knots[n - 1], after = knots[n + 1] - knots[n];
    const double pivot = 2.0 * (before + after) - before * upper[n - 1];
    upper[n] = after / pivot;
    const Vec3 bend = 6.0 * ((places[n + 1] - places[n]) / after - (places[n] - places[n - 1]) / before);
    second[n] = (bend - before * second[n - 1]) / pivot;
  }
  for (std::size_t n = count - 2; n > 0; --n) second[n] -= upper[n] * second[n + 1];
  return second;
}

/// The double reflection that takes axes from one place of a curve to the next one.
Vec3 carried_across(const Vec3& across, const Vec3& tangent, const Vec3& way_mm, const Vec3& next_tangent) {
  const double way_squared = way_mm.squaredNorm();
  if (!(way_squared > 0.0)) return across;
  const Vec3 mirrored = across - 2.0 / way_squared * way_mm.dot(across) * way_mm;
  const Vec3 mirrored_tangent = tangent - 2.0 / way_squared * way_mm.dot(tangent) * way_mm;
  const Vec3 second = next_tangent - mirrored_tangent;
  const double second_squared = second.squaredNorm();
  const Vec3 carried =
      second_squared > 0.0 ? Vec3(mirrored - 2.0 / second_squared * second.dot(mirrored) * second) : mirrored;
  // Rounding alone: a thousand pieces must not turn it out of the plane.
  return (carried - carried.dot(next_tangent) * next_tangent).normalized();
}

Mat3 axes_of(const Vec3& across, const Vec3& tangent) {
  Mat3 axes;
  axes.col(0) = across;
  axes.col(1) = tangent.cross(across);
  axes.col(2) = tangent;
  return axes;
}

}  // namespace

Vec3 PathCurve::Cubic::at(double u) const { return a + u * (b + u * (c + u * d)); }
Vec3 PathCurve::Cubic::first(double u) const { return b + u * (2.0 * c + u * (3.0 * d)); }
Vec3 PathCurve::Cubic::second(double u) const { return 2.0 * c + u * (6.0 * d); }

PathCurve::PathCurve(const DrillPath& path)
    : entry_mm_(path.entry_mm),
      target_mm_(path.target_mm),
      chord_(path.direction()),
      first_(chord_),
      last_(chord_),
      length_mm_(path.chord_mm()) {
  constexpr double kNearestMm = 0.1;
  std::vector<Vec3> places{path.entry_mm};
  places.insert(places.end(), path.via_mm.begin(), path.via_mm.end());
  places.push_back(path.target_mm);
  std::vector<double> knots{0.0};
  for (std::size_t n = 0; n < places.size(); ++n) {
    if (!places[n].allFinite()) {
      fail_as(ErrorKind::geometry, "path ", in_quotes(path.name),
              ": entry, target and places between must be finite numbers");
    }
    if (n == 0) continue;
    const double gap_mm = (places[n] - places[n - 1]).norm();
    if (!(gap_mm >= kNearestMm)) {
      fail_as(ErrorKind::geometry, "path ", in_quotes(path.name), ": expected its places ", kNearestMm,
              " mm apart or more, found ", gap_mm, " mm");
    }
    knots.push_back(knots.back() + gap_mm);
  }
  if (!path.is_curved()) {
    first_axes_ = last_axes_ = PathFrame(entry_mm_, chord_).axes();
    return;
  }
  const std::vector<Vec3> second = second_derivatives(places, knots);
  for (std::size_t n = 0; n + 1 < places.size(); ++n) {
    const double h = knots[n + 1] - knots[n];
    cubics_.push_back({places[n], (places[n + 1] - places[n]) / h - h / 6.0 * (2.0 * second[n] + second[n + 1]),
                       0.5 * second[n], (second[n + 1] - second[n]) / (6.0 * h)});
  }
  make_pieces(knots);
  measure_bends();
}

double PathCurve::arc_mm(const Cubic& cubic, double from_u, double to_u) const noexcept {
  // Gauss-Legendre, five points (Abramowitz & Stegun, table 25.4).
  constexpr std::array<double, 3> kAt{0.0, 0.53846931010568309104, 0.90617984593866399280};
  constexpr std::array<double, 3> kWeight{0.56888888888888888889, 0.47862867049936646804, 0.23692688505618908751};
  const double middle = 0.5 * (from_u + to_u), half = 0.5 * (to_u - from_u);
  double sum = kWeight[0] * cubic.first(middle).norm();
  for (std::size_t n = 1; n < kAt.size(); ++n) {
    sum += kWeight[n] * (cubic.first(middle - half * kAt[n]).norm() + cubic.first(middle + half * kAt[n]).norm());
  }
  return half * sum;
}

void PathCurve::make_pieces(const std::vector<double>& knots_mm) {
  constexpr double kLongestMm = 0.25;
  constexpr int kFewest = 16;  // of a cubic
  double along_mm = 0.0;
  const Vec3 first = cubics_.front().first(0.0);
  first_ = first.normalized();
  first_axes_ = PathFrame(entry_mm_, first_).axes();
  Vec3 tangent = first_, across = first_axes_.col(0);
  for (std::size_t n = 0; n < cubics_.size(); ++n) {
    const Cubic& cubic = cubics_[n];
    const double end = knots_mm[n + 1] - knots_mm[n];
    const int count = std::max(kFewest, static_cast<int>(std::ceil(end / kLongestMm)));
    for (int k = 0; k < count; ++k) {
      const double from_u = end * k / count, to_u = end * (k + 1) / count;
      const Vec3 begin_mm = cubic.at(from_u), end_mm = cubic.at(to_u);
      pieces_.push_back({n, from_u, to_u, along_mm, begin_mm, tangent, across});
      along_mm += arc_mm(cubic, from_u, to_u);
      const Vec3 next = cubic.first(to_u).normalized();
      across = carried_across(across, tangent, end_mm - begin_mm, next);
      tangent = next;
    }
  }
  length_mm_ = along_mm;
  last_ = tangent;
  last_axes_ = axes_of(across, tangent);
}

void PathCurve::measure_bends() {
  constexpr int kPlaces = 8;
  double tightest_per_mm = 0.0;
  double min_cosine = std::min(first_.dot(chord_), last_.dot(chord_));
  for (const Piece& piece : pieces_) {
    min_cosine = std::min(min_cosine, piece.tangent.dot(chord_));
    const Cubic& cubic = cubics_[piece.cubic];
    for (int k = 0; k < kPlaces; ++k) {
      const double u = piece.u_begin + (piece.u_end - piece.u_begin) * k / kPlaces;
      const Vec3 first = cubic.first(u);
      const double speed = first.norm();
      const double bend_per_mm = first.cross(cubic.second(u)).norm() / (speed * speed * speed);
      // A place where the curve stands still is a cusp.
      tightest_per_mm =
          bend_per_mm >= 0.0 ? std::max(tightest_per_mm, bend_per_mm) : std::numeric_limits<double>::infinity();
    }
  }
  min_radius_mm_ = 1.0 / tightest_per_mm;
  max_tilt_deg_ = std::acos(std::clamp(min_cosine, -1.0, 1.0)) / kDegree;
}

PathCurve::Spot PathCurve::spot_at(double along_mm) const noexcept {
  const auto after = std::upper_bound(pieces_.begin(), pieces_.end(), along_mm,
                                      [](double s, const Piece& piece) { return s < piece.s_begin; });
  const Piece& piece = after == pieces_.begin() ? *after : *(after - 1);
  const Cubic& cubic = cubics_[piece.cubic];
  const double end_mm = after == pieces_.end() ? length_mm_ : after->s_begin;
  const double share = (along_mm - piece.s_begin) / (end_mm - piece.s_begin);
  double u = piece.u_begin + share * (piece.u_end - piece.u_begin);
  // Newton's method on a length that is nearly straight in u.
  for (int round = 0; round < 2; ++round) {
    u -= (piece.s_begin + arc_mm(cubic, piece.u_begin, u) - along_mm) / cubic.first(u).norm();
    u = std::clamp(u, piece.u_begin, piece.u_end);
  }
  return {&piece, u};
}

Vec3 PathCurve::tangent_at(const Spot& spot) const noexcept {
  return cubics_[spot.piece->cubic].first(spot.u).normalized();
}

Vec3 PathCurve::at_mm(double along_mm) const noexcept {
  if (is_straight() || !(along_mm > 0.0)) return entry_mm_ + along_mm * first_;
  if (along_mm >= length_mm_) return target_mm_ + (along_mm - length_mm_) * last_;
  const Spot spot = spot_at(along_mm);
  return cubics_[spot.piece->cubic].at(spot.u);
}

Vec3 PathCurve::direction_at(double along_mm) const noexcept {
  if (is_straight() || !(along_mm > 0.0)) return first_;
  if (along_mm >= length_mm_) return last_;
  return tangent_at(spot_at(along_mm));
}

Pose PathCurve::pose_at(double along_mm) const noexcept { return {at_mm(along_mm), direction_at(along_mm)}; }

Vec3 PathCurve::between_mm(double from_mm, double to_mm) const noexcept {
  if (is_straight()) return (to_mm - from_mm) * first_;
  return at_mm(to_mm) - at_mm(from_mm);
}

double PathCurve::nearest_mm(const Vec3& p_mm) const noexcept {
  const double before_mm = (p_mm - entry_mm_).dot(first_);
  if (is_straight()) return before_mm;
  const auto squared_to = [&](double along_mm) { return (p_mm - at_mm(along_mm)).squaredNorm(); };
  double best_mm = std::min(before_mm, 0.0);
  double best_squared = squared_to(best_mm);
  const Piece* nearest = nullptr;
  double nearest_squared = std::numeric_limits<double>::infinity();
  for (const Piece& piece : pieces_) {
    const double squared = (p_mm - piece.begin_mm).squaredNorm();
    if (squared < nearest_squared) {
      nearest_squared = squared;
      nearest = &piece;
    }
  }
  // What is nearest lies in the piece that begins there or in the one before. Along both, halving finds where the way
  // to p stands across.
  if (nearest != nullptr) {
    const std::size_t n = static_cast<std::size_t>(nearest - pieces_.data());
    double low_mm = pieces_[n > 0 ? n - 1 : n].s_begin;
    double high_mm = n + 1 < pieces_.size() ? pieces_[n + 1].s_begin : length_mm_;
    const auto ahead_mm = [&](double along_mm) { return (p_mm - at_mm(along_mm)).dot(direction_at(along_mm)); };
    double low_ahead = ahead_mm(low_mm), high_ahead = ahead_mm(high_mm);
    double along_mm = low_ahead <= 0.0 ? low_mm : high_mm;
    if (low_ahead > 0.0 && high_ahead < 0.0) {
      // Regula falsi in its Illinois form: some six rounds to a nanometre.
      constexpr double kNearMm = 1e-7;
      for (int round = 0; round < 60 && high_mm - low_mm > kNearMm; ++round) {
        along_mm = std::clamp((low_mm * high_ahead - high_mm * low_ahead) / (high_ahead - low_ahead), low_mm, high_mm);
        const double here = ahead_mm(along_mm);
        if (std::abs(here) < kNearMm) break;
        if (here > 0.0) {
          low_mm = along_mm;
          low_ahead = here;
          high_ahead *= 0.5;
        } else {
          high_mm = along_mm;
          high_ahead = here;
          low_ahead *= 0.5;
        }
      }
    }
    if (const double squared = squared_to(along_mm); squared < best_squared) {
      best_squared = squared;
      best_mm = along_mm;
    }
  }
  const double past_mm = length_mm_ + std::max(0.0, (p_mm - target_mm_).dot(last_));
  return squared_to(past_mm) < best_squared ? past_mm : best_mm;
}

Mat3 PathCurve::axes_at(double along_mm) const noexcept {
  if (is_straight() || !(along_mm > 0.0)) return first_axes_;
  if (along_mm >= length_mm_) return last_axes_;
  const Spot spot = spot_at(along_mm);
  const Vec3 tangent = tangent_at(spot);
  const Vec3 way_mm = cubics_[spot.piece->cubic].at(spot.u) - spot.piece->begin_mm;
  return axes_of(carried_across(spot.piece->across, spot.piece->tangent, way_mm, tangent), tangent);
}

Vec3 PathCurve::to_patient(const Vec3& p_path) const noexcept {
  const Mat3 axes = axes_at(p_path.z());
  return at_mm(p_path.z()) + p_path.x() * axes.col(0) + p_path.y() * axes.col(1);
}

PathCurve::AboutChord PathCurve::about_chord(double from_mm, double to_mm) const {
  AboutChord about{0.0, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  const auto take = [&](const Vec3& p_mm) {
    const Vec3 from_entry_mm = p_mm - entry_mm_;
    const double along_mm = from_entry_mm.dot(chord_);
    about.off_mm = std::max(about.off_mm, (from_entry_mm - along_mm * chord_).norm());
    about.low_mm = std::min(about.low_mm, along_mm);
    about.high_mm = std::max(about.high_mm, along_mm);
  };
  take(at_mm(from_mm));
  take(at_mm(to_mm));
  for (const Piece& piece : pieces_) {
    if (piece.s_begin > from_mm && piece.s_begin < to_mm) take(piece.begin_mm);
  }
  return about;
}

std::vector<Vec3> PathCurve::places_mm(double step_mm) const {
  if (is_straight()) return {entry_mm_, target_mm_};
  const double steps = std::max(1.0, std::ceil(length_mm_ / step_mm));
  std::vector<Vec3> places;
  for (double n = 0.0; n <= steps; ++n) places.push_back(at_mm(length_mm_ * n / steps));
  return places;
}

}  // namespace spinaltap
