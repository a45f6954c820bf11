#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/force/drill_forces.h"
#include "core/plan/path_side.h"
#include "core/plan/wall_distance.h"
#include "core/points/material.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// Gertzbein & Robbins 1990: A no breach, B below 2 mm, C from 2 to below 4, D from 4 to below 6, E from 6 mm on.
enum class Grade { A, B, C, D, E };
/// Throws Error on a breach that is negative or not a number.
Grade gertzbein_robbins(double breach_mm);
/// 'A' to 'E'.
char letter_of(Grade grade);

/// CT numbers (HU) at positions (patient LPS, mm).
using HuSampler = std::function<void(std::span<const Vec3>, std::span<float>)>;

struct GradeOptions {
  double step_mm = 0.25;                       ///< along the path
  std::vector<double> hu_bands{135.0, 375.0};  ///< borders, ascending
  int ring_points = 48;                        ///< around the tool at each depth, where a breach is looked for
  Spindle spindle = {};                        ///< for the predicted thrust
  double feed_mm_s = 1.0;                      ///< the same; an operator's, and `drill`'s of 0.001 mm a cycle at 1 kHz
};

/// What a tool meets at one depth of the tip's way.
struct GradeRow {
  double depth_mm = 0.0;   ///< from the entry
  double radius_mm = 0.0;  ///< of the tool there, its tip at the target
  double outer_mm = 0.0;   ///< clearance of the tool's surface to the outer surface; negative: breach
  double canal_mm = 0.0;   ///< to the canal; infinite where the bone has none
  PathSide outer_side = PathSide::lateral;
  PathSide canal_side = PathSide::medial;
  bool is_entry = false;               ///< still in the entry opening: the outer surface does not count
  double hu = 0.0;                     ///< mean over the tool's section; NaN where no bone is
  std::vector<double> hu_band_shares;  ///< of the bone in that section, as PathGrade's; 0 where no bone is
  double thrust_n = 0.0;               ///< predicted, of drilling the hole with the path's bit, its tip there
};

/// A nearest approach: how near, at what depth, on which side. Infinite where nothing counts.
struct Approach {
  double clearance_mm = std::numeric_limits<double>::infinity();
  double depth_mm = 0.0;
  PathSide side = PathSide::medial;
};

struct PathGrade {
  Grade grade = Grade::A;
  double breach_mm = 0.0;        ///< of the tool's surface beyond the bone's, the entry opening not counted
  double breach_depth_mm = 0.0;  ///< where it is; of no meaning without one, as the next two
  PathSide breach_side = PathSide::lateral;
  bool breaches_canal = false;         ///< the breach is into the canal
  Approach outer, canal;               ///< nearest approaches; the one that is negative and lower is the breach
  bool is_left = true;                 ///< graded as a path through the left pedicle, the nearer one
  double entry_end_mm = 0.0;           ///< depth from which on the outer surface counts
  double hu = 0.0;                     ///< mean of the tool's volume in bone; NaN where there is none
  std::vector<double> hu_band_shares;  ///< one more than there are borders; of the tool's volume in bone; sum 1
  double max_thrust_n = 0.0;
  std::vector<GradeRow> rows;
};

/// Grades a drill or, where the path has one, a screw on a path; docs/grading.md has the rules. Throws Error on paths,
/// materials and options that make no sense, and without a sampler.
PathGrade grade_path(const WallDistance& walls, const HuSampler& hu, const Material& material, const DrillPath& path,
                     const GradeOptions& options = {});

/// Only grade_path()'s entry_end_mm: the depth from which on the outer surface counts, for the path's screw or, where
/// it has none, its bit. The path's length where it never does.
double entry_end_mm(const WallDistance& walls, const DrillPath& path, const GradeOptions& options = {});

/// Only the breach of grade_path(), mm, in a fraction of its time: 0 when the tool stays in the bone.
double breach_mm(const WallDistance& walls, const DrillPath& path, const GradeOptions& options = {});

}  // namespace spinaltap
