#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/ct/hu_to_density.h"
#include "core/force/drill_force.h"
#include "core/grading/path_findings.h"
#include "core/grading/screw_fixation.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

class WallDistance;
struct Material;

/// Gertzbein & Robbins 1990: A no breach, B below 2 mm, C from 2 to below 4, D from 4 to below 6, E from 6 mm on.
enum class Grade { A, B, C, D, E };
/// Throws Error on a breach that is negative or not a number.
Grade gertzbein_robbins(double breach_mm);
/// 'A' to 'E'.
char letter_of(Grade grade);

/// Rampersaud et al. 2005: A within the bone, B up to 2 mm beyond it, C to 4 mm, D more. Throws as gertzbein_robbins().
char rampersaud(double breach_mm);

/// Heary, Bono & Black 2004, made for thoracic screws: I within the bone; II through the pedicle's lateral wall, with
/// the tip in the body; III the tip through the body's front or side; IV through the pedicle's medial or caudal wall
/// (the cranial one, which the scale does not name, counts here too); V cord, root or great vessel endangered, which a
/// person decides: told from a canal breach of 4 mm on.
enum class Heary { I, II, III, IV, V };
/// "I" to "V".
const char* name_of(Heary grade);

/// Babu et al. 2012, of screw and head in the superior articular process: 0 not in the facet; 1 in its lateral part,
/// not in the joint; 2 the joint surface is penetrated; 3 the screw runs within the joint, here told from 1 mm of depth
/// on.
int babu(const InstrumentContacts& contacts);

/// How finely a path is graded, and by which models.
struct GradeOptions {
  double step_mm = 0.25;                       ///< along the path
  std::vector<double> hu_bands{135.0, 375.0};  ///< borders, ascending
  int ring_points = 48;                        ///< around the tool at each depth, where a breach is looked for
  Spindle spindle = {};                        ///< for the predicted thrust
  double feed_mm_s = 1.0;                      ///< the same; an operator's, and `drill`'s of 0.001 mm a cycle at 1 kHz
  FixationModel fixation = {};                 ///< for how well a screw holds
};

/// What a tool meets at one depth of the tip's way.
struct GradeRow {
  double depth_mm = 0.0;   ///< from the entry
  double radius_mm = 0.0;  ///< of the tool there, its tip at the target
  /// Clearance of the tool's section to the outer surface; negative: that far beyond it. From 3 mm on the axis' own
  /// clearance less the radius, which is at most that.
  double outer_mm = 0.0;
  double canal_mm = 0.0;  ///< to the canal; infinite where the bone has none
  PathSide outer_side = PathSide::lateral;
  PathSide canal_side = PathSide::medial;
  bool is_opening = false;             ///< in the entry opening: the outer surface is pierced there on purpose
  bool is_entry = false;               ///< so near to it that what is nearest is the surface around the opening
  double hu = 0.0;                     ///< mean over the tool's section; NaN where no bone is
  std::vector<double> hu_band_shares;  ///< of the bone in that section, as PathGrade's; 0 where no bone is
  double thrust_n = 0.0;               ///< predicted, of drilling the hole with the path's bit, its tip there
  Interval thrust_band_n = {};         ///< 5 % and 95 % of it, as sources differ; see ForceBand
};

/// A nearest approach: how near, at what depth, on which side. Infinite where nothing counts.
struct Approach {
  double clearance_mm = std::numeric_limits<double>::infinity();
  double depth_mm = 0.0;
  PathSide side = PathSide::medial;
  Vec3 normal = Vec3::Zero();  ///< of the wall there: unit, out of the bone, patient LPS; zero where none is near
};

/// How safe a path is: grade_path(). Lengths in mm, depths along the path from the entry.
struct PathGrade {
  Grade grade = Grade::A;
  double breach_mm = 0.0;        ///< of the tool's surface beyond the bone's, behind the entry opening's end
  double breach_depth_mm = 0.0;  ///< where it is; of no meaning without one, as the next two
  PathSide breach_side = PathSide::lateral;
  bool breaches_canal = false;             ///< the breach is into the canal
  std::array<double, 5> side_breach_mm{};  ///< the largest breach to each PathSide
  char rampersaud = 'A';
  Heary heary = Heary::I;
  int facet = 0;  ///< babu()
  /// Nearest approaches of the tool's surface; negative where, and only where, it breaches that wall.
  Approach outer, canal;
  InstrumentContacts instrument;  ///< of all behind the entry
  std::vector<Finding> findings;  ///< of it, of the entry, of the breach and of neighbours, warnings first
  /// With other vertebrae, where they are known: grade_path() knows of none, note_neighbours() adds it.
  std::optional<NeighbourContact> neighbour = {};
  /// What of the bone it leans on that may not be so: grade_path() knows of none, note_doubts() adds it.
  std::vector<PathDoubt> doubts = {};
  bool is_left = true;           ///< graded as a path through the left pedicle, the nearer one
  double opening_end_mm = 0.0;   ///< depth from which on whatever stands out of the bone is a breach
  double bearing_mm = 0.0;       ///< depth from which on bone bears the whole section; infinite where it never does
  double entry_slant_deg = 0.0;  ///< between the path and the surface's normal at the entry; NaN away from bone
  double entry_end_mm = 0.0;     ///< depth from which on the nearest approach to the outer surface counts
  double hu = 0.0;               ///< mean of the tool's volume in bone; NaN where there is none
  std::vector<double> hu_band_shares;  ///< one more than there are borders; of the tool's volume in bone; sum 1
  double max_thrust_n = 0.0;
  std::optional<ScrewFixation> fixation;  ///< of the path's screw; nothing where it has none
  Interval max_thrust_band_n = {};
  std::vector<GradeRow> rows;
};

/// Grades a drill or, where the path has one, a screw on a path; docs/grading.md has the rules. Throws Error on paths,
/// materials and options that make no sense, and without a sampler.
PathGrade grade_path(const WallDistance& walls, const HuSampler& hu, const Material& material, const DrillPath& path,
                     const GradeOptions& options = {});

/// Adds to the grade of `path` what it meets of other vertebrae, with a finding where that is over kTouchMm.
void note_neighbours(std::span<const Neighbour> neighbours, const DrillPath& path, PathGrade& grade);

/// Adds to the grade of `path` what it leans on, with a finding for each, a warning.
void note_doubts(const DoubtfulBone& bone, const DrillPath& path, PathGrade& grade);

/// "A", or "A, but 3.2 mm of it lie in slices that were made up": the letter with the doubts that take it its worth.
std::string grade_in_words(const PathGrade& grade);

/// Only grade_path()'s entry_end_mm, for the path's screw or, where it has none, its bit. The path's length where the
/// outer surface never counts.
double entry_end_mm(const WallDistance& walls, const DrillPath& path, const GradeOptions& options = {});

/// Only the breach of grade_path(), mm, in a fraction of its time: 0 when the tool stays in the bone.
double breach_mm(const WallDistance& walls, const DrillPath& path, const GradeOptions& options = {});

}  // namespace spinaltap
