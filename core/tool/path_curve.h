#pragma once

#include <limits>
#include <vector>

#include "core/tool/drill_path.h"

namespace spinaltap {

/// The way of a path by the length along it, s: 0 at the entry, length_mm() at the target, and straight on beyond both.
/// A straight path is its line. A curved one is the natural cubic spline (curvature 0 at its ends, continuous between)
/// through entry, places between and target, with chord lengths as its parameter (de Boor, A Practical Guide to
/// Splines, ch. IV), measured by Gauss's rule of five points over pieces of at most 0.25 mm: places by s are exact to
/// better than 1 µm. Positions are patient LPS, mm.
class PathCurve {
 public:
  /// Throws Error where points are not finite or neighbours nearer than 0.1 mm, but checks no more of the path.
  explicit PathCurve(const DrillPath& path);

  bool is_straight() const { return pieces_.empty(); }
  double length_mm() const { return length_mm_; }
  /// Unit, from entry to target.
  const Vec3& chord() const { return chord_; }

  Vec3 at_mm(double along_mm) const noexcept;
  /// Unit, towards the target.
  Vec3 direction_at(double along_mm) const noexcept;
  /// Tip there, axis along the path.
  Pose pose_at(double along_mm) const noexcept;
  /// From one place of the path to another, mm.
  Vec3 between_mm(double from_mm, double to_mm) const noexcept;
  /// s of the place that is nearest to p, before the entry and past the target too; the first of two equally near. Some
  /// microseconds, without memory.
  double nearest_mm(const Vec3& p_mm) const noexcept;

  /// Path-local axes at s as columns, z along the path. At the entry they are PathFrame's; along the path they turn as
  /// little as can be (the rotation-minimising frame by double reflection, Wang et al., ACM Trans Graph 2008).
  Mat3 axes_at(double along_mm) const noexcept;
  /// A place given as (x, y, s): x and y across the path at s.
  Vec3 to_patient(const Vec3& p_path) const noexcept;

  /// Tightest bend's radius; infinite where straight. Looked for at 8 places of each piece.
  double min_radius_mm() const { return min_radius_mm_; }
  /// Largest angle between the way and its chord, deg: 0 where straight, as looked for at both ends of each piece.
  double max_tilt_deg() const { return max_tilt_deg_; }

  /// Where the way lies about its chord, the line from entry to target, over s from `from_mm` to `to_mm`.
  struct AboutChord {
    double off_mm = 0.0;  ///< how far from the chord's line, at most
    double low_mm = 0.0;  ///< along it from the entry, the first and the last
    double high_mm = 0.0;
  };
  AboutChord about_chord(double from_mm, double to_mm) const;
  /// Places of the way from entry to target, at most `step_mm` apart; of a straight path its two ends.
  std::vector<Vec3> places_mm(double step_mm) const;

 private:
  /// c(u) = a + u (b + u (c + u d)), u from 0 to its end: what the spline is between two places.
  struct Cubic {
    Vec3 a, b, c, d;
    Vec3 at(double u) const;
    Vec3 first(double u) const;
    Vec3 second(double u) const;
  };
  /// A short part of a cubic.
  struct Piece {
    std::size_t cubic;
    double u_begin, u_end;
    double s_begin;
    Vec3 begin_mm;
    Vec3 tangent, across;  ///< at its begin; path-local z and x
  };
  struct Spot {
    const Piece* piece;
    double u;
  };

  void make_pieces(const std::vector<double>& knots_mm);
  void measure_bends();
  Spot spot_at(double along_mm) const noexcept;
  double arc_mm(const Cubic& cubic, double from_u, double to_u) const noexcept;
  Vec3 tangent_at(const Spot& spot) const noexcept;

  Vec3 entry_mm_, target_mm_, chord_;
  Vec3 first_, last_;  ///< tangents at entry and target
  Mat3 first_axes_, last_axes_;
  double length_mm_ = 0.0;
  double min_radius_mm_ = std::numeric_limits<double>::infinity();
  double max_tilt_deg_ = 0.0;
  std::vector<Cubic> cubics_;
  std::vector<Piece> pieces_;  ///< none: straight
};

}  // namespace spinaltap
