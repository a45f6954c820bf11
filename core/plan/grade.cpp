#include "core/plan/grade.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/plan/detail/graded_tool.h"
#include "core/plan/detail/inside_bone.h"
#include "core/plan/detail/tool_sections.h"

namespace spinaltap {
namespace {

void check_options(const GradeOptions& options) {
  constexpr double kFinestMm = 0.01, kCoarsestMm = 5.0;
  if (!(options.step_mm >= kFinestMm && options.step_mm <= kCoarsestMm)) {
    fail("grade: expected a step of ", kFinestMm, " to ", kCoarsestMm, " mm, found ", options.step_mm, " mm");
  }
  constexpr int kFewest = 8, kMax = 720;
  if (options.ring_points < kFewest || options.ring_points > kMax) {
    fail("grade: expected ", kFewest, " to ", kMax, " points of a ring, found ", options.ring_points);
  }
  constexpr double kFastestRpm = 1e6, kFastestMmS = 1e3;
  if (!(options.spindle.rpm > 0.0 && options.spindle.rpm <= kFastestRpm)) {
    fail("grade: expected a spindle of above 0 to ", kFastestRpm, " rpm, found ", options.spindle.rpm, " rpm");
  }
  if (!(options.feed_mm_s > 0.0 && options.feed_mm_s <= kFastestMmS)) {
    fail("grade: expected a feed of above 0 to ", kFastestMmS, " mm/s, found ", options.feed_mm_s, " mm/s");
  }
  for (std::size_t n = 0; n < options.hu_bands.size(); ++n) {
    if (!std::isfinite(options.hu_bands[n]) || (n > 0 && !(options.hu_bands[n] > options.hu_bands[n - 1]))) {
      fail("grade: expected borders of HU bands that ascend, found ", options.hu_bands[n], " HU");
    }
  }
}

std::vector<double> depths_of(double length_mm, double step_mm) {
  std::vector<double> depths_mm;
  for (int n = 0; step_mm * n < length_mm - 1e-6; ++n) depths_mm.push_back(step_mm * n);
  depths_mm.push_back(length_mm);
  return depths_mm;
}

/// How many rows belong to the entry opening: until the whole section is in bone for the first time, and then until
/// what is nearest of the outer surface is no longer the entry opening itself, but lies as deep as that section or
/// deeper; at the latest 4 mm before the pedicle's isthmus.
std::size_t rows_of_entry(const WallDistance& walls, const GradedTool& tool, const SideNames& sides,
                          std::span<const GradeRow> rows, std::span<const WallDistance::Walls> axis, int ring_points) {
  constexpr double kBeforeIsthmusMm = 4.0;
  const Vec3 entry_mm = tool.axis_mm(0.0);
  const double latest_mm = (sides.pedicle().isthmus_mm - entry_mm).dot(tool.direction()) - kBeforeIsthmusMm;
  double whole_mm = std::numeric_limits<double>::infinity();  // depth of the first section that is all in bone
  for (std::size_t n = 0; n < rows.size(); ++n) {
    if (!(rows[n].depth_mm < latest_mm)) return n;
    if (!(axis[n].nearer_mm() > 0.0)) continue;
    if (!std::isfinite(whole_mm)) {
      const Vec3 towards = SideNames::towards(tool.axis_mm(rows[n].depth_mm), axis[n].outer);
      const std::vector<Vec3> ring = ring_mm(tool, rows[n].depth_mm, rows[n].radius_mm, towards, ring_points);
      const std::vector<std::uint8_t> inside = inside_bone(walls.bone(), ring);
      if (!std::all_of(inside.begin(), inside.end(), [](std::uint8_t one) { return one != 0; })) continue;
      whole_mm = rows[n].depth_mm;
    }
    if ((axis[n].outer.nearest_mm - entry_mm).dot(tool.direction()) >= whole_mm) return n;
  }
  return rows.size();
}

/// What the tool's axis meets on its way.
struct Walk {
  std::vector<GradeRow> rows;  ///< without CT numbers
  std::vector<WallDistance::Walls> axis;
  std::size_t entry_rows = 0;

  double entry_end_mm(const GradedTool& tool) const {
    return entry_rows < rows.size() ? rows[entry_rows].depth_mm : tool.length_mm();
  }
};

Walk walk_along(const WallDistance& walls, const GradedTool& tool, const SideNames& sides,
                const GradeOptions& options) {
  Walk walk;
  for (const double depth_mm : depths_of(tool.length_mm(), options.step_mm)) {
    const Vec3 p_mm = tool.axis_mm(depth_mm);
    walk.axis.push_back(walls.walls(p_mm));
    const WallDistance::Walls& at = walk.axis.back();
    GradeRow row;
    row.depth_mm = depth_mm;
    row.radius_mm = tool.radius_mm(depth_mm);
    row.outer_mm = at.outer.distance_mm - row.radius_mm;
    row.canal_mm = at.canal.distance_mm - row.radius_mm;
    row.outer_side = sides.of(p_mm, at.outer);
    row.canal_side = sides.of(p_mm, at.canal);
    walk.rows.push_back(row);
  }
  walk.entry_rows = rows_of_entry(walls, tool, sides, walk.rows, walk.axis, options.ring_points);
  for (std::size_t n = 0; n < walk.entry_rows; ++n) walk.rows[n].is_entry = true;
  return walk;
}

Approach nearest_of(Approach so_far, double clearance_mm, double depth_mm, PathSide side) {
  return clearance_mm < so_far.clearance_mm ? Approach{clearance_mm, depth_mm, side} : so_far;
}

}  // namespace

Grade gertzbein_robbins(double breach_mm) {
  if (!(breach_mm >= 0.0)) fail("grade: expected a breach of 0 mm or more, found ", breach_mm, " mm");
  if (breach_mm == 0.0) return Grade::A;
  if (breach_mm < 2.0) return Grade::B;
  if (breach_mm < 4.0) return Grade::C;
  return breach_mm < 6.0 ? Grade::D : Grade::E;
}

char letter_of(Grade grade) { return static_cast<char>('A' + static_cast<int>(grade)); }

PathGrade grade_path(const WallDistance& walls, const HuSampler& hu, const Material& material, const DrillPath& path,
                     const GradeOptions& options) {
  check_options(options);
  check_material(material);
  if (!hu) fail("grade: expected a sampler of CT numbers");
  const GradedTool tool(path);
  const SideNames sides(walls.landmarks(), path);
  Walk walk = walk_along(walls, tool, sides, options);

  PathGrade graded;
  graded.is_left = sides.is_left();
  graded.entry_end_mm = walk.entry_end_mm(tool);
  graded.rows = std::move(walk.rows);
  std::vector<double> depths_mm;
  depths_mm.reserve(graded.rows.size());
  for (const GradeRow& row : graded.rows) depths_mm.push_back(row.depth_mm);
  const ToolSections sections(walls.bone(), hu, material, tool, path.bit, depths_mm, options.step_mm, options.hu_bands);
  const double feed_mm = options.feed_mm_s * 60.0 / options.spindle.rpm;
  for (std::size_t n = 0; n < graded.rows.size(); ++n) {
    GradeRow& row = graded.rows[n];
    row.hu = sections.hu(n);
    row.hu_band_shares = sections.band_shares(n);
    row.thrust_n = sections.resistance(n).thrust_n(feed_mm);
    graded.max_thrust_n = std::max(graded.max_thrust_n, row.thrust_n);
    if (!row.is_entry) graded.outer = nearest_of(graded.outer, row.outer_mm, row.depth_mm, row.outer_side);
    graded.canal = nearest_of(graded.canal, row.canal_mm, row.depth_mm, row.canal_side);
  }
  graded.hu = sections.mean_hu();
  graded.hu_band_shares = sections.band_shares();

  const FoundBreach breach = find_breach(walls, tool, graded.rows, walk.axis, options.ring_points);
  graded.breach_mm = breach.breach_mm;
  graded.grade = gertzbein_robbins(breach.breach_mm);
  if (breach.breach_mm > 0.0) {
    graded.breach_depth_mm = breach.depth_mm;
    graded.breaches_canal = breach.is_canal;
    graded.breach_side = sides.of(breach.place_mm, breach.wall);
  }
  return graded;
}

double entry_end_mm(const WallDistance& walls, const DrillPath& path, const GradeOptions& options) {
  check_options(options);
  const GradedTool tool(path);
  return walk_along(walls, tool, SideNames(walls.landmarks(), path), options).entry_end_mm(tool);
}

double breach_mm(const WallDistance& walls, const DrillPath& path, const GradeOptions& options) {
  check_options(options);
  const GradedTool tool(path);
  const Walk walk = walk_along(walls, tool, SideNames(walls.landmarks(), path), options);
  return find_breach(walls, tool, walk.rows, walk.axis, options.ring_points).breach_mm;
}

}  // namespace spinaltap
