#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/anatomy/bone_shape.h"
#include "core/grading/detail/breach_field.h"
#include "core/grading/detail/graded_tool.h"
#include "core/grading/path_side.h"
#include "core/grading/screw_breach.h"

namespace spinaltap {

/// The breaches of one path, as grading finds them from all rows and rings: what cannot be among them is left out by
/// bounds, from the lattice of the bone's shape and from nearest points, so that a path takes some microseconds.
class FastBreach {
 public:
  FastBreach(const BreachField& field, const DrillPath& path);

  /// As find_breaches() of all rows.
  FoundBreaches find();
  /// As side_breaches() of all rows.
  std::array<double, 5> sides(const FoundBreaches& found, ScrewSides wanted = ScrewSides::all);
  PathSide side_of(const FoundBreach& breach) const { return sides_.of(breach.place_mm, breach.wall); }

  /// Bone beside the tool, to any surface, where that is no longer the one around the entry opening: to 0.1 mm. At
  /// least 0; infinite where nothing counts.
  double clearance_mm();

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  struct Row {
    double depth_mm;
    double radius_mm;            ///< negative until it is asked for
    double lattice_mm;           ///< of the axis
    double inside_mm;            ///< the axis is as deep in the bone as that, or deeper
    bool is_deep;                ///< all the tool's section is in the bone; lattice_mm is not known
    bool is_whole = false;       ///< all places of the ring that find() looks at are
    std::size_t sample = kNone;  ///< the nearest to the axis, once it is asked for
    double squared_mm2 = 0.0;    ///< to it
    std::size_t axis = kNone;    ///< in axes_
  };
  /// What the axis sees.
  struct Axis {
    WallDistance::Wall nearer;
    bool is_canal = false;                    ///< the nearer wall
    std::optional<WallDistance::Walls> both;  ///< where it was not sure which one is nearer, or the other was wanted
  };

  double radius_mm(Row& row) const;
  void find_sample(Row& row) const;
  Axis& axis_of(Row& row);
  const WallDistance::Walls& both_of(Row& row);
  /// Whether the axis is as near as that to the wall that is not the nearer one: as both_of() tells it.
  bool is_other_within(Row& row, double within_mm);
  /// At most this of the tool stands out at a row.
  double max_breach_mm(Row& row) const;
  /// The same, by how deep another row's axis is in the bone: closer where a wall slants.
  struct Beside {
    double max_mm;
    std::size_t from;  ///< that row
  };
  Beside max_beside(std::size_t n);
  /// Closer, from the nearest sample of the other row.
  double closer_max_beside_mm(std::size_t n, std::size_t other);
  /// As max_breach_mm(), closer, from nearest samples of some rows.
  double closer_max_breach_mm(std::size_t n);
  bool is_in(const Row& row) const;
  bool is_whole(Row& row);
  bool is_surely_cut(const Row& row, double radius_mm);
  void find_opening();
  /// The surface's value at each of suspect_mm_.
  std::span<const double> suspect_values_mm();
  /// False only where a place beyond the wall is to another side for sure.
  bool may_be_anterior(const Vec3& p_mm, std::size_t sample) const;
  /// Visits places of the ring that are out of the bone, each with the surface's value and the nearest sample; not all
  /// of those that are out by least_mm() or less, nor those that `may_matter` tells not to, of a place and the most
  /// that its nearest sample may be away.
  template <class LeastMm, class MayMatter, class Visit>
  void for_each_beyond(Row& row, const RingTurns& turns, const LeastMm& least_mm, const MayMatter& may_matter,
                       const Visit& visit);

  const BreachField& field_;
  const BoneShape& bone_;
  GradedTool tool_;
  SideNames sides_;
  std::vector<Row> rows_;
  std::vector<Axis> axes_;
  WallDistance::Walls last_both_;  ///< where the next search of both begins
  std::size_t first_in_ = 0;       ///< whose axis is in the bone
  std::size_t opening_rows_ = 0;   ///< in which the outer surface does not count
  std::size_t last_cut_ = 0;       ///< where around the tool is_surely_cut() found it
  std::vector<Vec3> suspect_mm_;   ///< places of a ring that may be out of the bone
  std::vector<std::size_t> suspect_turns_;
  std::vector<std::size_t> turn_samples_;  ///< the last that was found of each turn of rings
  std::vector<double> values_mm_;
};

}  // namespace spinaltap
