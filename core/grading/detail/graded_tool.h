#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/anatomy/bone_shape.h"
#include "core/grading/grade.h"
#include "core/grading/path_side.h"
#include "core/tool/bit_profile.h"
#include "core/tool/path_curve.h"

namespace spinaltap {

/// Throws Error on options of grading that make no sense.
void check_grade_options(const GradeOptions& options);

/// The body that is graded: what a path's screw, or its bit where it has none, fills on its way from the entry until
/// its tip is at the target. Depths are along the path, from the entry.
class GradedTool {
 public:
  /// Throws Error as check_path() does.
  explicit GradedTool(const DrillPath& path);

  const PathCurve& curve() const { return curve_; }
  double length_mm() const { return curve_.length_mm(); }
  Vec3 axis_mm(double depth_mm) const { return curve_.at_mm(depth_mm); }
  Vec3 direction_at(double depth_mm) const { return curve_.direction_at(depth_mm); }
  /// A unit vector across the path, which turns about it as little as can be.
  Vec3 across_at(double depth_mm) const;
  /// The depth that a place is nearest to.
  double along_mm(const Vec3& p_mm) const { return curve_.nearest_mm(p_mm); }

  /// The hole's radius there; 0 beyond the tip.
  double radius_mm(double depth_mm) const;
  double widest_mm() const { return profile_.radius_mm(); }
  /// "screw" or "bit".
  const std::string& name() const { return name_; }

 private:
  BitProfile profile_;
  std::string name_;
  PathCurve curve_;
};

/// Turns of places around an axis: cosines and sines, evenly spaced from 1 and 0 on.
struct RingTurns {
  explicit RingTurns(int count);
  std::vector<double> cosines, sines;
};

/// A circle around the tool at a depth.
class ToolRing {
 public:
  /// Turns are counted from `towards`.
  ToolRing(const GradedTool& tool, double depth_mm, double radius_mm, const Vec3& towards);

  const Vec3& centre_mm() const { return centre_mm_; }
  Vec3 place_mm(double cosine, double sine) const;

 private:
  Vec3 centre_mm_, first_, second_;
  double radius_mm_;
};

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

/// Of each wall.
struct FoundBreaches {
  FoundBreach outer, canal;
  const FoundBreach& larger() const { return canal.breach_mm > outer.breach_mm ? canal : outer; }
};

/// The distance of a breach without what its nearest sample lies beside the surface's nearest place: that is looked for
/// along the tangent planes.
void sharpen_breach(const BoneShape& bone, FoundBreach& breach);

/// Looks on rings at all rows' depths; in rows of the entry opening only beyond the canal's wall. `axis`: the walls as
/// seen from the axis, one of each row.
FoundBreaches find_breaches(const WallDistance& walls, const GradedTool& tool, std::span<const GradeRow> rows,
                            std::span<const WallDistance::Walls> axis, int ring_points);

/// What side_breaches() looks on.
inline constexpr double kSideRingsApartMm = 1.0;
inline constexpr int kSideRingPoints = 16;

/// The largest breach to each PathSide, on rings a millimetre apart: to about 0.2 mm, and `found` to their own.
std::array<double, 5> side_breaches(const WallDistance& walls, const GradedTool& tool, const SideNames& sides,
                                    std::span<const GradeRow> rows, std::span<const WallDistance::Walls> axis,
                                    const FoundBreaches& found);

}  // namespace spinaltap
