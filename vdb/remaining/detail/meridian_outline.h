#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/tool/bit_profile.h"
#include "core/tool/plate.h"

namespace spinaltap::detail {

/// Distance to a body of revolution (mm, negative inside) and its slope along (back from the tip, off the axis).
struct MeridianSample {
  double distance_mm = 0.0;
  double per_back = 0.0;
  double per_off = 0.0;
};

/// The closed outline of some pieces of a bit in the half plane of (back from the tip, off the axis), mm: their walls,
/// the steps between them and both flat ends. BitProfile::distance_mm() with a slope.
class MeridianOutline {
 public:
  /// At least one and at most kMaxPieces pieces.
  explicit MeridianOutline(std::span<const ProfilePiece> pieces);

  MeridianSample at(double back_mm, double off_mm) const noexcept;
  /// The distance alone: the same, but for rounding.
  double distance_mm(double back_mm, double off_mm) const noexcept;

 private:
  static constexpr std::size_t kMaxPieces = kMaxStretches + 2;  // lengthened by a cylinder
  struct Line {
    double back_mm, off_mm;              ///< begin
    double along_back_mm, along_off_mm;  ///< to the end
    double per_length_squared;           ///< 1 / mm2
    double out_back, out_off;            ///< unit, outward
  };
  struct Arc {
    double centre_mm, radius_mm, begin_mm, end_mm, begin_off_mm, end_off_mm;
  };
  bool contains(double back_mm, double off_squared_mm2) const noexcept;
  void add_line(double back_mm, double off_mm, double to_back_mm, double to_off_mm);

  std::array<Line, 2 * kMaxPieces + 1> lines_{};
  std::array<Arc, kMaxPieces> arcs_{};
  std::array<ProfilePiece, kMaxPieces> pieces_{};
  std::size_t line_count_ = 0;
  std::size_t arc_count_ = 0;
  std::size_t piece_count_ = 0;
};

/// A bit as distances need it: the outline of a body of revolution, or a plate's box.
class BitOutline {
 public:
  explicit BitOutline(const BitProfile& profile);
  explicit BitOutline(const PlateBox& plate);

  /// Of a plate; null for bodies of revolution.
  const PlateBox* box() const { return box_ ? &*box_ : nullptr; }
  /// Of bodies of revolution only.
  const MeridianOutline& whole() const { return *whole_; }
  /// Convex bodies that make up the bit: one for a drill, head and shank for a burr; none for a plate, whose box is
  /// one. Along a straight line the distance to each falls to its least value and rises from there on.
  std::span<const MeridianOutline> convex_parts() const { return parts_; }
  bool is_convex() const { return parts_.size() < 2; }
  double length_mm() const { return length_mm_; }
  /// How far off its axis the bit reaches; of a plate, at its corners.
  double radius_mm() const { return radius_mm_; }
  /// Where the bit is an upright cylinder, back from the tip; empty (begin = end) where it ends otherwise.
  double cylinder_begin_mm() const { return cylinder_begin_mm_; }

 private:
  std::optional<MeridianOutline> whole_;
  std::optional<PlateBox> box_;
  std::vector<MeridianOutline> parts_;
  double length_mm_;
  double radius_mm_;
  double cylinder_begin_mm_;
};

}  // namespace spinaltap::detail
