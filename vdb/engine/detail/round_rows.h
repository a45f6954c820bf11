#pragma once

#include <array>
#include <cstddef>

#include "core/base/geometry.h"
#include "vdb/engine/detail/tool_bounds.h"
#include "vdb/engine/detail/word_kernels.h"

namespace spinaltap::detail {

/// A tool's balls and cylinders, as rows of a leaf's voxels are put to them (see RowArguments).
///
/// What lies within one at some moment of the way is held. For what may have been reached, let D be how far the tool
/// goes between two moments, seen from a voxel's chord (see SweptBit): a chord that meets a ball of radius r has an end
/// within sqrt(r^2 + (D/2)^2) of its centre. Of a short straight way its end alone is looked at: nothing lives in the
/// tool and its skin where it begins, and a chord that comes in from outside ends within sqrt(r^2 + D^2). The begin is
/// looked at too where the skin may have grown, on ways that turn, and beyond the piece's ends, where something may
/// live within its ball or cylinder.
class RoundRows {
 public:
  RoundRows(const ToolBounds& bounds, double voxel_mm);

  /// Bit n: piece n of the tool is a ball or a cylinder.
  unsigned pieces() const { return pieces_; }

  /// Begins a step.
  void take(const SweptBounds& tool) noexcept;

  /// A leaf against piece `number`: its first voxel at `first_mm`, its centre and what reaches it as `tool` has them.
  void put(std::size_t number, const std::uint64_t* words, const Vec3& first_mm, const BitPlace& centre, double half_mm,
           const SweptBounds::Reach& reach, RowArguments& rows) const noexcept;

  /// What the least square of a voxel's distance comes to as a bound from piece `number`, see from_round_mm().
  double bound_mm(std::size_t number, float square) const noexcept;

 private:
  static constexpr std::size_t kMaxParts = RowArguments::kMostPlaces - 1;
  struct Moment {
    Vec3 tip_mm, axis;
  };
  struct Round {
    bool is_ball = false;
    double radius_mm = 0.0;
    double begin_mm = 0.0, end_mm = 0.0;  ///< infinite where the ball itself ends
    double centre_mm = 0.0;               ///< of a ball, back from the tip
    double rounding = 0.0;                ///< what it may hide of a square, in voxels
  };

  double voxel_mm_;
  unsigned pieces_ = 0;
  std::array<Round, ToolBounds::kMaxPieces> rounds_;
  std::array<Moment, kMaxParts + 1> moments_;
  std::size_t parts_ = 1;
  double per_piece_ = 1.0;  ///< how much of a piece of the way a part of it is
  double skin_mm_ = 0.0;    ///< by which the outline that is swept is larger
  bool is_end_enough_ = false;
};

}  // namespace spinaltap::detail
