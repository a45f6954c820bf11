#pragma once

#include <span>
#include <vector>

#include "core/plan/detail/graded_tool.h"
#include "core/plan/grade.h"

namespace spinaltap {

/// Places around the tool at a depth, evenly spaced, the first of them towards `towards`; one where the radius is 0.
std::vector<Vec3> ring_mm(const GradedTool& tool, double depth_mm, double radius_mm, const Vec3& towards, int count);

/// The tool's place that is furthest beyond the bone.
struct FoundBreach {
  double breach_mm = 0.0;
  double depth_mm = 0.0;
  bool is_canal = false;
  Vec3 place_mm = Vec3::Zero();
  WallDistance::Wall wall;
};

/// Looks on rings at all rows' depths; in rows of the entry only beyond the canal's wall. `axis`: the walls as seen
/// from the axis, one of each row.
FoundBreach find_breach(const WallDistance& walls, const GradedTool& tool, std::span<const GradeRow> rows,
                        std::span<const WallDistance::Walls> axis, int ring_points);

}  // namespace spinaltap
