#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/phantom/level_body.h"
#include "core/phantom/spine_curve.h"
#include "core/phantom/spine_options.h"

namespace spinaltap {

/// Numbers of a spine's bodies that are no vertebrae, in label maps. A sacrum has VerSe's number, 26.
inline constexpr std::uint8_t kRibLabel = 50, kOtherBoneLabel = 51;

/// A bony spur: a rod with round ends, cut off by a plane. Patient LPS, mm.
struct Spur {
  Vec3 root_mm, tip_mm;
  double radius_mm;
  Vec3 plane_normal;       ///< unit, away from the spur
  double plane_offset_mm;  ///< of the plane along its normal; beyond it the spur has nothing
};

/// One body of a spine.
struct SpinePart {
  /// Another part that this one keeps a distance from: what lies nearer to it is taken away.
  struct Cut {
    std::size_t part;
    double gap_mm;
  };

  std::uint8_t label = 0;  ///< VerSe's number of its level, kRibLabel or kOtherBoneLabel
  std::shared_ptr<const Solid> solid;
  std::vector<Cut> cuts{};
  std::vector<Spur> spurs{};                   ///< joined to it after the cuts
  std::shared_ptr<const Vertebra> vertebra{};  ///< where it is one in closed form
};

/// Several bodies as one to scan: vertebrae in closed form, ribs, a sacrum, or any solids under the names of levels. A
/// point belongs to the body with the lowest value there.
///
/// evaluate() gives the least of the bodies' values, or the distance to a body's bounds where that is more, so that far
/// from a body only its bounds are looked at.
class Spine : public Solid {
 public:
  /// Any bodies, as they stand. Throws Error without any, with over 96, or on a cut that names no other part.
  explicit Spine(std::vector<SpinePart> parts);
  /// Vertebrae from their measures, along the curve: see SpineOptions. Throws Error on options without sense, and when
  /// a neighbour's gap reaches a pedicle's isthmus.
  explicit Spine(const SpineOptions& options);

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3> gradients) const override;
  Box3 bounds_mm() const override { return bounds_; }
  double hu(const Vec3& p_patient, double distance_mm, double aperture_mm) const override;

  std::size_t part_count() const { return parts_.size(); }
  const SpinePart& part(std::size_t n) const { return parts_[n]; }
  /// Value of one part, its cuts and spurs included, as evaluate() has it.
  double part_value_mm(std::size_t n, const Vec3& p_patient) const;
  /// The part of a level, nothing where there is none.
  std::optional<std::size_t> part_of(Level level) const;
  /// Label of the part that holds a point; 0 where none does.
  std::uint8_t label_at(const Vec3& p_patient) const;

  /// The placed levels, from above, that the options made; empty for any bodies.
  const std::vector<PlacedLevel>& placed() const { return placed_; }

 private:
  struct Nearest {
    double value_mm;
    std::size_t part;
  };
  class Values;

  void finish();
  Nearest nearest(const Vec3& p) const;

  std::vector<SpinePart> parts_;
  std::vector<Box3> boxes_;
  std::vector<PlacedLevel> placed_;
  Box3 bounds_;
};

/// Solids under the names of levels, the upper ones first, moved so that each stands above the next: midlines and
/// fronts of their bounds in line, and `gap_mm` between each two at the closest. Frames: x left, y back, z up, mm.
/// Throws Error when no place is found within the bounds' heights.
Spine stacked_spine(std::vector<SpinePart> parts, double gap_mm);

}  // namespace spinaltap
