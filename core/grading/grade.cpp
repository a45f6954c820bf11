#include "core/grading/grade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "core/anatomy/bone_density.h"
#include "core/anatomy/inside_bone.h"
#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/force/force_band.h"
#include "core/grading/detail/graded_tool.h"
#include "core/grading/detail/tool_sections.h"
#include "core/grading/instrument.h"
#include "core/grading/path_side.h"
#include "core/tool/plate.h"

namespace spinaltap {

void check_grade_options(const GradeOptions& options) {
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

namespace {

std::vector<double> depths_of(double length_mm, double step_mm) {
  std::vector<double> depths_mm;
  for (int n = 0; step_mm * n < length_mm - 1e-6; ++n) depths_mm.push_back(step_mm * n);
  depths_mm.push_back(length_mm);
  return depths_mm;
}

bool is_whole(const WallDistance& walls, const GradedTool& tool, const GradeRow& row, const WallDistance::Walls& axis,
              int ring_points) {
  if (!(axis.nearer_mm() > 0.0)) return false;
  const Vec3 towards = SideNames::towards(tool.axis_mm(row.depth_mm), axis.outer);
  const std::vector<std::uint8_t> inside =
      inside_bone(walls.bone(), ring_mm(tool, row.depth_mm, row.radius_mm, towards, ring_points));
  return std::all_of(inside.begin(), inside.end(), [](std::uint8_t one) { return one != 0; });
}

/// What the tool's axis meets on its way.
struct Walk {
  std::vector<GradeRow> rows;  ///< without CT numbers
  std::vector<WallDistance::Walls> axis;
  std::size_t entry_rows = 0;
  double opening_end_mm = 0.0;
  double bearing_mm = std::numeric_limits<double>::infinity();

  double entry_end_mm(const GradedTool& tool) const {
    return entry_rows < rows.size() ? rows[entry_rows].depth_mm : tool.length_mm();
  }
};

/// The entry's surface never counts for longer than to 4 mm before the pedicle's isthmus.
double latest_entry_end_mm(const GradedTool& tool, const SideNames& sides) {
  constexpr double kBeforeIsthmusMm = 4.0;
  return tool.along_mm(sides.pedicle().isthmus_mm) - kBeforeIsthmusMm;
}

/// Finds where bone first bears the whole section, the end of the entry opening, and of the rows whose nearest place of
/// the outer surface is the surface around it: until that lies as deep as the first whole section or deeper; at the
/// latest 4 mm before the pedicle's isthmus.
void find_entry(const WallDistance& walls, const GradedTool& tool, const SideNames& sides, int ring_points,
                Walk& walk) {
  const double latest_mm = latest_entry_end_mm(tool, sides);
  double limit_mm = 0.0;  // a tool whose axis never enters bone makes no opening
  bool is_in = false;
  for (std::size_t n = 0; n < walk.rows.size(); ++n) {
    const GradeRow& row = walk.rows[n];
    if (!is_in && walk.axis[n].nearer_mm() > 0.0) {
      is_in = true;
      limit_mm = row.depth_mm + opening_limit_mm(tool.widest_mm());
    }
    if (!is_in || !is_whole(walls, tool, row, walk.axis[n], ring_points)) continue;
    walk.bearing_mm = row.depth_mm;
    break;
  }
  walk.opening_end_mm = std::min(limit_mm, walk.bearing_mm);
  for (GradeRow& row : walk.rows) row.is_opening = row.depth_mm < walk.opening_end_mm;
  const auto first =
      std::find_if(walk.rows.begin(), walk.rows.end(), [](const GradeRow& row) { return !row.is_opening; });
  walk.opening_end_mm = first == walk.rows.end() ? tool.length_mm() : first->depth_mm;

  walk.entry_rows = walk.rows.size();
  for (std::size_t n = 0; n < walk.rows.size(); ++n) {
    const double deep_mm = tool.along_mm(walk.axis[n].outer.nearest_mm);
    const bool has_left =
        walk.rows[n].depth_mm >= walk.bearing_mm && walk.axis[n].nearer_mm() > 0.0 && deep_mm >= walk.bearing_mm;
    if (walk.rows[n].depth_mm < latest_mm && !has_left) continue;
    walk.entry_rows = n;
    break;
  }
  for (std::size_t n = 0; n < walk.entry_rows; ++n) walk.rows[n].is_entry = true;
}

/// To the target, or to the first depth from `until_mm` on.
Walk walk_along(const WallDistance& walls, const GradedTool& tool, const SideNames& sides, const GradeOptions& options,
                double until_mm = std::numeric_limits<double>::infinity()) {
  Walk walk;
  for (const double depth_mm : depths_of(tool.length_mm(), options.step_mm)) {
    const Vec3 p_mm = tool.axis_mm(depth_mm);
    walk.axis.push_back(walk.axis.empty() ? walls.walls(p_mm) : walls.walls(p_mm, walk.axis.back()));
    const WallDistance::Walls& at = walk.axis.back();
    GradeRow row;
    row.depth_mm = depth_mm;
    row.radius_mm = tool.radius_mm(depth_mm);
    row.outer_mm = at.outer.distance_mm - row.radius_mm;
    row.canal_mm = at.canal.distance_mm - row.radius_mm;
    row.outer_side = sides.of(p_mm, at.outer);
    row.canal_side = sides.of(p_mm, at.canal);
    walk.rows.push_back(row);
    if (depth_mm >= until_mm) break;
  }
  find_entry(walls, tool, sides, options.ring_points, walk);
  return walk;
}

/// The samples of one wall near a tool, along it. Sections nearer to the wall than 3 mm ask them how near they are: the
/// axis alone knows that of walls beside the tool, not of those ahead of a section.
class WallAlongTool {
 public:
  static constexpr double kNearMm = 3.0;

  struct Sample {
    double along_mm, off_mm;  ///< from the entry, and from the axis
    std::size_t index;
  };

  /// `near`: the wall's, at least those that near_tool() finds.
  WallAlongTool(const WallDistance& walls, const GradedTool& tool, std::span<const Sample> near)
      : walls_(walls), tool_(tool), first_mm_(-reach_mm(tool)) {
    // By slices: sections ask those beside them first, and most of the others never.
    slice_begins_.resize(slice_of(tool.length_mm() + reach_mm(tool)) + 2);
    for (const Sample& sample : near) ++slice_begins_[slice_of(sample.along_mm)];
    std::partial_sum(slice_begins_.begin(), slice_begins_.end(), slice_begins_.begin());
    samples_.resize(near.size());
    for (const Sample& sample : near) samples_[--slice_begins_[slice_of(sample.along_mm)]] = sample;
  }

  /// Those of the outer surface and those of the canal's wall.
  static std::array<std::vector<Sample>, 2> near_tool(const WallDistance& walls, const GradedTool& tool) {
    const BoneShape& bone = walls.bone();
    const Vec3 entry_mm = tool.axis_mm(0.0);
    const double far_mm = reach_mm(tool);
    const PathCurve& curve = tool.curve();
    const PathCurve::AboutChord about = curve.about_chord(0.0, curve.length_mm());
    std::array<std::vector<Sample>, 2> found;
    for (const std::size_t n : bone.tree().along(
             {entry_mm, curve.chord(), about.low_mm - far_mm, about.high_mm + far_mm, about.off_mm + far_mm})) {
      const Vec3 from_mm = bone.points_mm()[n] - entry_mm;
      const double along_mm = tool.along_mm(bone.points_mm()[n]);
      if (along_mm < -far_mm || along_mm > tool.length_mm() + far_mm) continue;
      const double off_squared = curve.is_straight() ? from_mm.squaredNorm() - along_mm * along_mm
                                                     : (bone.points_mm()[n] - tool.axis_mm(along_mm)).squaredNorm();
      if (off_squared > far_mm * far_mm) continue;
      found[walls.landmarks().is_canal_wall[n] != 0 ? 1 : 0].push_back(
          {along_mm, std::sqrt(std::max(0.0, off_squared)), n});
    }
    return found;
  }

  /// How far from the axis, and beyond the tool's ends, samples can matter.
  static double reach_mm(const GradedTool& tool) { return tool.widest_mm() + kNearMm + 1.0; }

  /// How far the section at a depth is from the wall, `axis_mm`: its middle is.
  double clearance_mm(double depth_mm, double radius_mm, double axis_mm) const {
    constexpr double kCrossingMm = 0.5 * BoneShape::kSampleMm;
    const Vec3 centre_mm = tool_.axis_mm(depth_mm), axis = tool_.direction_at(depth_mm);
    const bool is_straight = tool_.curve().is_straight();
    double best_squared = (axis_mm + 0.1) * (axis_mm + 0.1);
    std::optional<Sample> best;
    const std::size_t slices = slice_begins_.size() - 1;
    std::size_t below = slice_of(depth_mm) + 1, above = below;  // looked at so far: from below on, up to above
    while (true) {
      const double behind_mm = below > 0 ? depth_mm - edge_mm(below) : std::numeric_limits<double>::infinity();
      const double ahead_mm = above < slices ? edge_mm(above) - depth_mm : std::numeric_limits<double>::infinity();
      const double gap_mm = std::max(0.0, std::min(behind_mm, ahead_mm));
      // Of curves, on whose inner side places are nearer than along them, all are asked.
      if (is_straight ? gap_mm > kCrossingMm && gap_mm * gap_mm > best_squared : below == 0 && above == slices) break;
      const std::size_t slice = behind_mm <= ahead_mm ? --below : above++;
      for (std::size_t n = slice_begins_[slice]; n < slice_begins_[slice + 1]; ++n) {
        const Sample one = is_straight ? samples_[n] : seen_from(centre_mm, axis, depth_mm, samples_[n].index);
        const double away_mm = one.along_mm - depth_mm;
        const double beside_mm = std::max(0.0, one.off_mm - radius_mm);
        if (beside_mm == 0.0 && std::abs(away_mm) < kCrossingMm) return axis_mm - radius_mm;  // the wall crosses it
        const double squared = beside_mm * beside_mm + away_mm * away_mm;
        if (squared > best_squared || (squared == best_squared && (!best || best->index < one.index))) continue;
        best_squared = squared;
        best = one;
      }
    }
    if (!best) return axis_mm - radius_mm;
    const Vec3& sample_mm = walls_.bone().points_mm()[best->index];
    const Vec3 across_mm = sample_mm - centre_mm - (best->along_mm - depth_mm) * axis;
    const double off_mm = across_mm.norm();
    const Vec3 nearest_mm =
        off_mm > radius_mm ? Vec3(centre_mm + radius_mm / off_mm * across_mm) : Vec3(centre_mm + across_mm);
    return without_sampling_error_mm(nearest_mm, sample_mm, walls_.bone().normals()[best->index], BoneShape::kSampleMm);
  }

 private:
  static constexpr double kSliceMm = 0.25;
  std::size_t slice_of(double along_mm) const { return static_cast<std::size_t>((along_mm - first_mm_) / kSliceMm); }
  double edge_mm(std::size_t slice) const { return first_mm_ + kSliceMm * static_cast<double>(slice); }
  /// A sample along and off the line that stands across a section.
  Sample seen_from(const Vec3& centre_mm, const Vec3& axis, double depth_mm, std::size_t index) const {
    const Vec3 way_mm = walls_.bone().points_mm()[index] - centre_mm;
    const double ahead_mm = way_mm.dot(axis);
    return {depth_mm + ahead_mm, (way_mm - ahead_mm * axis).norm(), index};
  }

  const WallDistance& walls_;
  const GradedTool& tool_;
  double first_mm_;                        ///< where along the tool the first slice begins
  std::vector<std::size_t> slice_begins_;  ///< of each slice, the first of samples_; and where the last ends
  std::vector<Sample> samples_;
};

/// Makes near clearances those of the sections instead of bounds by their middles: never less than the bound.
void sharpen_clearances(const WallDistance& walls, const GradedTool& tool, Walk& walk) {
  const auto near = WallAlongTool::near_tool(walls, tool);
  const WallAlongTool outer(walls, tool, near[0]), canal(walls, tool, near[1]);
  for (std::size_t n = 0; n < walk.rows.size(); ++n) {
    GradeRow& row = walk.rows[n];
    const auto sharpen = [&](double& clearance_mm, double axis_mm, const WallAlongTool& wall) {
      // Where bone ends before the rim does, the rings say by how much.
      if (!(axis_mm > 0.0) || clearance_mm > WallAlongTool::kNearMm) return;
      clearance_mm = std::max(clearance_mm, wall.clearance_mm(row.depth_mm, row.radius_mm, axis_mm));
    };
    sharpen(row.outer_mm, walk.axis[n].outer.distance_mm, outer);
    sharpen(row.canal_mm, walk.axis[n].canal.distance_mm, canal);
  }
}

Approach nearest_of(const Approach& so_far, double clearance_mm, double depth_mm, PathSide side,
                    const WallDistance::Wall& wall) {
  return clearance_mm < so_far.clearance_mm ? Approach{clearance_mm, depth_mm, side, wall.normal} : so_far;
}

std::string tenths(double value) { return fixed_text(value, 1); }

/// The grade, and words for it. A nearest approach and the breach have one sign: places of rings decide.
void add_breach(const WallDistance& walls, const GradedTool& tool, const SideNames& sides,
                const FoundBreaches& breaches, std::span<const WallDistance::Walls> axis, PathGrade& graded) {
  const auto agree = [&](Approach& approach, const FoundBreach& breach, const char* wall) {
    if (breach.breach_mm > 0.0) {
      if (-breach.breach_mm < approach.clearance_mm) {
        approach = {-breach.breach_mm, breach.depth_mm, sides.of(breach.place_mm, breach.wall), breach.wall.normal};
      }
      return;
    }
    if (!(approach.clearance_mm < 0.0)) return;
    Finding hollow{InstrumentPart::tool,
                   VertebraPart::pedicle,
                   -approach.clearance_mm,
                   approach.depth_mm,
                   tool.axis_mm(approach.depth_mm),
                   false,
                   ""};
    hollow.words = "a hollow of the " + std::string(wall) + " lies in the tool's volume at " +
                   tenths(approach.depth_mm) + " mm of depth; its surface stays in bone";
    graded.findings.push_back(hollow);
    approach.clearance_mm = 0.0;
  };
  agree(graded.outer, breaches.outer, "outer surface");
  agree(graded.canal, breaches.canal, "canal's wall");
  const FoundBreach& breach = breaches.larger();
  graded.breach_mm = breach.breach_mm;
  graded.grade = gertzbein_robbins(breach.breach_mm);
  graded.side_breach_mm = side_breaches(walls, tool, sides, graded.rows, axis, breaches);
  if (!(breach.breach_mm > 0.0)) return;
  graded.breach_depth_mm = breach.depth_mm;
  graded.breaches_canal = breach.is_canal;
  graded.breach_side = sides.of(breach.place_mm, breach.wall);
  const VertebraPart part = walls.parts().at(breach.wall.nearest_mm, breach.wall.normal);
  Finding finding{InstrumentPart::tool, part, breach.breach_mm, breach.depth_mm, breach.place_mm, true, ""};
  finding.words = "the " + tool.name() + " stands " +
                  (breach.breach_mm < 0.05 ? std::string("less than 0.1") : tenths(breach.breach_mm)) +
                  " mm out of the " + name_of(part) + (breach.is_canal ? " into the canal" : "") + ", " +
                  name_of(graded.breach_side) + ", at " + tenths(breach.depth_mm) + " mm of depth";
  graded.findings.push_back(finding);
}

/// How the tool meets the surface at its entry.
void add_entry(const WallDistance& walls, const DrillPath& path, const GradedTool& tool, PathGrade& graded) {
  constexpr double kWalksDeg = 45.0, kSlantsDeg = 30.0, kNearMm = 3.0;
  constexpr int kAround = 12;
  const BoneShape& bone = walls.bone();
  // The mean over what the bit stands on when it begins to turn.
  const PointTree::Nearest nearest = bone.nearest(path.entry_mm);
  Vec3 normal = Vec3::Zero();
  if (nearest.distance_mm < kNearMm) {
    normal = bone.normals()[nearest.index];
    const double around_mm = std::max(1.0, path.bit.radius_mm());
    const Vec3 u = any_perpendicular(normal), v = normal.cross(u);
    const Vec3 middle_mm = bone.points_mm()[nearest.index];
    for (const double share : {0.5, 1.0}) {
      for (int n = 0; n < kAround; ++n) {
        const double angle = 2.0 * std::numbers::pi * n / kAround;
        const Vec3 p_mm = middle_mm + share * around_mm * (std::cos(angle) * u + std::sin(angle) * v);
        normal += bone.normals()[bone.nearest(p_mm).index];
      }
    }
  }
  graded.entry_slant_deg = std::numeric_limits<double>::quiet_NaN();
  if (normal.norm() > 0.0) {
    graded.entry_slant_deg =
        std::acos(std::clamp(-normal.normalized().dot(tool.direction_at(0.0)), -1.0, 1.0)) / kDegree;
  }
  if (graded.entry_slant_deg > kSlantsDeg) {
    const bool walks = graded.entry_slant_deg > kWalksDeg;
    const double burr_mm = path.bit.radius_mm() * std::tan(std::min(graded.entry_slant_deg, 80.0) * kDegree);
    Finding finding{InstrumentPart::tool, VertebraPart::lamina, burr_mm, 0.0, path.entry_mm, walks, ""};
    finding.structure = walls.parts().at(path.entry_mm, normal.normalized());
    finding.words = "the surface at the entry slants by " + tenths(graded.entry_slant_deg) + " degrees" +
                    (walks ? ", where a bit walks" : "") + ": flatten it with a burr, " + tenths(burr_mm) + " mm deep";
    graded.findings.push_back(finding);
  }
  // Bone that begins to bear the section late, though the opening ended before: said even where it is graded already.
  if (graded.bearing_mm > graded.opening_end_mm && graded.breach_mm > 0.0) {
    Finding finding{InstrumentPart::tool, VertebraPart::lamina, 0.0, graded.opening_end_mm, path.entry_mm, false, ""};
    finding.words = std::isfinite(graded.bearing_mm)
                        ? "bone bears the whole section only from " + tenths(graded.bearing_mm) + " mm of depth on"
                        : std::string("bone bears the whole section nowhere");
    graded.findings.push_back(finding);
  }
}

void add_scales(const WallDistance& walls, const DrillPath& path, const FoundBreaches& breaches, PathGrade& graded) {
  constexpr double kEndangersMm = 4.0;
  graded.rampersaud = rampersaud(graded.breach_mm);
  graded.facet = babu(graded.instrument);
  const auto beyond = [&](PathSide side) { return graded.side_breach_mm[static_cast<std::size_t>(side)] > 0.0; };
  const Landmarks& marks = walls.landmarks();
  const double back_of_body_mm = marks.to_own(marks.body.centre_mm).y() + 0.5 * marks.body.depth_mm;
  const bool tip_is_in_body =
      walls.bone().is_inside(path.target_mm) && marks.to_own(path.target_mm).y() < back_of_body_mm;
  const bool is_in_body = breaches.outer.breach_mm > 0.0 && marks.to_own(breaches.outer.place_mm).y() < back_of_body_mm;
  if (breaches.canal.breach_mm >= kEndangersMm) {
    graded.heary = Heary::V;
  } else if (breaches.canal.breach_mm > 0.0 || beyond(PathSide::medial) || beyond(PathSide::caudal) ||
             beyond(PathSide::cranial)) {
    graded.heary = Heary::IV;
  } else if (beyond(PathSide::anterior) || (beyond(PathSide::lateral) && (is_in_body || !tip_is_in_body))) {
    graded.heary = Heary::III;
  } else {
    graded.heary = beyond(PathSide::lateral) ? Heary::II : Heary::I;
  }
}

}  // namespace

Grade gertzbein_robbins(double breach_mm) {
  if (!(breach_mm >= 0.0)) fail("grade: expected a breach of 0 mm or more, found ", breach_mm, " mm");
  if (breach_mm == 0.0) return Grade::A;
  if (breach_mm < 2.0) return Grade::B;
  if (breach_mm < 4.0) return Grade::C;
  return breach_mm < 6.0 ? Grade::D : Grade::E;
}

char rampersaud(double breach_mm) {
  if (!(breach_mm >= 0.0)) fail("grade: expected a breach of 0 mm or more, found ", breach_mm, " mm");
  if (breach_mm == 0.0) return 'A';
  if (breach_mm <= 2.0) return 'B';
  return breach_mm <= 4.0 ? 'C' : 'D';
}

const char* name_of(Heary grade) {
  constexpr std::array<const char*, 5> kNames{"I", "II", "III", "IV", "V"};
  return kNames[static_cast<std::size_t>(grade)];
}

int babu(const InstrumentContacts& contacts) {
  constexpr double kWithinMm = 1.0;
  if (contacts.joint_depth_mm > kWithinMm) return 3;
  if (contacts.joint_depth_mm > 0.0) return 2;
  return contacts.is_beside_joint ? 1 : 0;
}

char letter_of(Grade grade) { return static_cast<char>('A' + static_cast<int>(grade)); }

PathGrade grade_path(const WallDistance& walls, const HuSampler& hu, const Material& material, const DrillPath& path,
                     const GradeOptions& options) {
  check_grade_options(options);
  check_material(material);
  if (!hu) fail("grade: expected a sampler of CT numbers");
  check_turns(path.bit, "a grade");
  const GradedTool tool(path);
  const SideNames sides(walls.landmarks(), path);
  Walk walk = walk_along(walls, tool, sides, options);
  sharpen_clearances(walls, tool, walk);

  PathGrade graded;
  graded.is_left = sides.is_left();
  graded.opening_end_mm = walk.opening_end_mm;
  graded.bearing_mm = walk.bearing_mm;
  graded.entry_end_mm = walk.entry_end_mm(tool);
  graded.rows = std::move(walk.rows);
  std::vector<double> depths_mm;
  depths_mm.reserve(graded.rows.size());
  for (const GradeRow& row : graded.rows) depths_mm.push_back(row.depth_mm);
  const ToolSections sections(walls.bone(), hu, material, tool, path.bit, options.spindle.rpm, depths_mm,
                              options.step_mm, options.hu_bands);
  const ForceBand band(material);
  const double feed_mm = options.feed_mm_s * 60.0 / options.spindle.rpm;
  for (std::size_t n = 0; n < graded.rows.size(); ++n) {
    GradeRow& row = graded.rows[n];
    row.hu = sections.hu(n);
    row.hu_band_shares = sections.band_shares(n);
    row.thrust_n = sections.resistance(n).thrust_n(feed_mm);
    row.thrust_band_n = band.thrust_n(row.thrust_n);
    graded.max_thrust_n = std::max(graded.max_thrust_n, row.thrust_n);
    const auto& [outer, canal] = walk.axis[n];
    if (!row.is_entry) graded.outer = nearest_of(graded.outer, row.outer_mm, row.depth_mm, row.outer_side, outer);
    graded.canal = nearest_of(graded.canal, row.canal_mm, row.depth_mm, row.canal_side, canal);
  }
  graded.max_thrust_band_n = band.thrust_n(graded.max_thrust_n);
  graded.hu = sections.mean_hu();
  graded.hu_band_shares = sections.band_shares();

  if (path.screw) {
    graded.fixation = screw_fixation(path, bone_density(walls.bone(), hu, material.density), options.fixation);
  }

  const FoundBreaches breaches = find_breaches(walls, tool, graded.rows, walk.axis, options.ring_points);
  graded.instrument = instrument_contacts(walls, path, opening_limit_mm(tool.widest_mm()));
  add_breach(walls, tool, sides, breaches, walk.axis, graded);
  add_entry(walls, path, tool, graded);
  add_scales(walls, path, breaches, graded);
  for (const Finding& finding : graded.instrument.findings) graded.findings.push_back(finding);
  std::stable_partition(graded.findings.begin(), graded.findings.end(),
                        [](const Finding& finding) { return finding.is_warning; });
  return graded;
}

double entry_end_mm(const WallDistance& walls, const DrillPath& path, const GradeOptions& options) {
  check_grade_options(options);
  const GradedTool tool(path);
  const SideNames sides(walls.landmarks(), path);
  return walk_along(walls, tool, sides, options, latest_entry_end_mm(tool, sides)).entry_end_mm(tool);
}

double breach_mm(const WallDistance& walls, const DrillPath& path, const GradeOptions& options) {
  check_grade_options(options);
  check_turns(path.bit, "a grade");
  const GradedTool tool(path);
  const Walk walk = walk_along(walls, tool, SideNames(walls.landmarks(), path), options);
  return find_breaches(walls, tool, walk.rows, walk.axis, options.ring_points).larger().breach_mm;
}

}  // namespace spinaltap
