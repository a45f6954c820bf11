#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/anatomy/bone_shape.h"
#include "core/anatomy/wall_distance.h"
#include "core/grading/detail/graded_tool.h"
#include "core/grading/detail/nearest_cells.h"
#include "core/grading/grade.h"

namespace spinaltap {

/// What breaches of very many paths in one bone are found with. Safe to ask from many threads.
class BreachField {
 public:
  /// Options must have been checked; `walls` must outlive this.
  BreachField(const WallDistance& walls, const GradeOptions& options);

  const WallDistance& walls() const { return walls_; }
  const BoneShape& bone() const { return walls_.bone(); }
  double step_mm() const { return step_mm_; }
  const RingTurns& turns() const { return turns_; }
  const RingTurns& side_turns() const { return side_turns_; }

  /// As BoneShape::nearest(): place in its points.
  std::size_t nearest(const Vec3& p_mm) const { return cells_.nearest(p_mm); }
  /// Of places that are asked for soon.
  void expect(std::span<const Vec3> places_mm) const { cells_.expect(places_mm); }
  const Vec3& sample_mm(std::size_t sample) const { return points_mm_[sample]; }
  bool is_canal(std::size_t sample) const { return walls_.landmarks().is_canal_wall[sample] != 0; }
  /// As WallDistance::walls(), sooner: `sample` is the nearest().
  WallDistance::Walls walls(const Vec3& p_mm, const WallDistance::Walls& beside, std::size_t sample) const;
  /// The least that a place can be from the outer surface, or from the canal's wall; infinite where the bone has none.
  double outer_at_least_mm(const Vec3& p_mm) const { return at_least_mm(outer_squared_mm2_, p_mm); }
  double canal_at_least_mm(const Vec3& p_mm) const { return at_least_mm(canal_squared_mm2_, p_mm); }

 private:
  void measure_walls();
  static double at_least_mm(const FloatGrid& to_wall_mm2, const Vec3& p_mm);

  const WallDistance& walls_;
  const std::vector<Vec3>& points_mm_;  ///< of the bone
  double step_mm_;
  RingTurns turns_, side_turns_;
  NearestCells cells_;
  std::vector<std::uint32_t> in_wall_;  ///< of each sample, its place among those of its wall
  /// Squared distances to the nearest sample of a wall, or up to kSampleMm nearer, and far away less; infinite without
  /// one.
  FloatGrid outer_squared_mm2_, canal_squared_mm2_;
};

}  // namespace spinaltap
