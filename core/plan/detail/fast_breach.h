#pragma once

#include <algorithm>
#include <vector>

#include "core/plan/detail/graded_tool.h"
#include "core/plan/grade.h"
#include "core/plan/path_side.h"

namespace spinaltap {

/// breach_mm() for very many paths: the lattice of the bone's shape leaves out what is deep in the bone, and the
/// distances that grading asks for are asked for near the walls only. Options must have been checked.
class FastBreach {
 public:
  FastBreach(const WallDistance& walls, const DrillPath& path, const GradeOptions& options);

  struct Breaches {
    double outer_mm = 0.0, canal_mm = 0.0;
    double larger_mm() const { return std::max(outer_mm, canal_mm); }
  };
  /// Through each wall. The larger is that of breach_mm(); the other one is above 0 where there is a breach.
  Breaches breaches() const;

  /// Bone beside the tool, to any surface, where that is no longer the one around the entry opening: to 0.1 mm. At
  /// least 0; infinite where nothing counts.
  double clearance_mm() const;

 private:
  struct Row {
    double depth_mm, radius_mm;
    double lattice_mm;  ///< of the axis
  };
  bool is_in(const Row& row) const;
  bool is_whole(const Row& row) const;
  void find_opening();
  /// The least that a row's axis can be from the canal's wall.
  std::vector<double> least_canal_mm() const;

  const WallDistance& walls_;
  GradedTool tool_;
  SideNames sides_;
  int ring_points_;
  std::vector<Row> rows_;
  std::size_t first_in_ = 0;      ///< whose axis is in the bone
  std::size_t opening_rows_ = 0;  ///< in which the outer surface does not count
};

}  // namespace spinaltap
