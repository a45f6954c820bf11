#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "core/base/geometry.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// Throws Error that tells what is made for tools that turn only, where one is a plate: "a grade".
void check_turns(const DrillBit& tool, std::string_view what);

/// How a plate at a sound pose sees points, in rows: along its width, along its thickness, back from its edge.
Mat3 plate_rows(const Pose& pose) noexcept;

/// A plate as a box, seen from itself: x along its width, y along its thickness, both from the middle, z back from its
/// edge. mm.
class PlateBox {
 public:
  /// Throws Error where the bit is no plate, and as check_bit does.
  explicit PlateBox(const DrillBit& plate);

  const Vec3& low_mm() const { return low_mm_; }
  const Vec3& high_mm() const { return high_mm_; }
  double length_mm() const { return high_mm_.z(); }
  /// From the tip, the middle of the edge, to the corner that is furthest from it.
  double reach_mm() const;
  /// The box, larger to all sides.
  PlateBox grown(double by_mm) const;
  /// What it sweeps on a way of `way_mm` forward along its axis, from the edge at the end of the way.
  PlateBox lengthened(double way_mm) const;

  /// The surface counts as inside.
  bool contains(const Vec3& seen) const noexcept {
    return (seen.array() >= low_mm_.array()).all() && (seen.array() <= high_mm_.array()).all();
  }
  /// Exact signed distance, negative inside, and where it grows fastest, unit.
  struct Sample {
    double distance_mm = 0.0;
    Vec3 gradient = Vec3::Zero();
  };
  Sample sample(const Vec3& seen) const noexcept;

 private:
  Vec3 low_mm_, high_mm_;
};

/// A plate and the larger ones that decide what it sweeps, by the skins of SweepProfile.
struct PlateSweep {
  explicit PlateSweep(const DrillBit& plate);

  PlateBox box;
  PlateBox straight;  ///< for straight ways
  PlateBox turning;
};

/// A plate on its way from one sound pose to another, as SweptBit is a body of revolution: seen from the plate a point
/// moves along a chord; it is removed where that meets the box.
class SweptPlate {
 public:
  enum class Way { straight, turning };

  /// `sweep` must outlive the object. Poses in any one frame, mm, with axis and side unit and across each other.
  SweptPlate(const PlateSweep& sweep, const Pose& from, const Pose& to, Way way = Way::straight) noexcept;

  const Pose& from() const { return from_; }
  const Pose& to() const { return to_; }
  const Mat3& from_rows() const { return from_rows_; }
  const Mat3& to_rows() const { return to_rows_; }
  /// What points are tested against: the plate with its skin.
  const PlateBox& box() const { return *box_; }

  bool contains(const Vec3& p) const noexcept;

 private:
  const PlateBox* box_;
  Pose from_, to_;
  Mat3 from_rows_, to_rows_;
};

/// The way between two sound poses of a plate: the tip goes straight, the plate turns evenly about one direction, in
/// pieces short enough for SweptPlate: chord and arc part by less than half a skin, as of BitMotion.
class PlateMotion {
 public:
  /// `sweep` must outlive the object and its pieces.
  PlateMotion(const PlateSweep& sweep, const Pose& from, const Pose& to) noexcept;

  std::size_t piece_count() const { return pieces_; }
  SweptPlate piece(std::size_t number) const noexcept { return {*sweep_, pose(number), pose(number + 1), way_}; }
  /// Pose after the first `piece` pieces; the first and the last are exactly those given.
  Pose pose(std::size_t piece) const noexcept;
  /// Pose at a share of the way within [0, 1].
  Pose pose_at(double share) const noexcept;
  /// How far chord and arc part, at most, where the whole way is taken for one piece: of n they part by 1 / n² of it.
  double bend_mm() const { return bend_mm_; }

 private:
  const PlateSweep* sweep_;
  Pose from_, to_;
  Vec3 about_ = Vec3::UnitZ();  ///< unit
  double angle_rad_ = 0.0;
  double bend_mm_ = 0.0;
  SweptPlate::Way way_ = SweptPlate::Way::straight;
  std::size_t pieces_ = 1;
};

}  // namespace spinaltap
