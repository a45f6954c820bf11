#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/ct/hu_to_density.h"
#include "core/ct/level.h"
#include "core/grading/grade.h"
#include "core/grading/path_findings.h"

namespace spinaltap {

class WallDistance;
struct Material;

/// What a good path is worth. Each term runs from 0 to 1; docs/planning.md has them.
struct SuggestWeights {
  double length = 1.0;      ///< how far into the body the tip comes
  double diameter = 2.0;    ///< of the screw, against the widest that is allowed
  double clearance = 1.5;   ///< of the path's axis to any surface, on its way through the pedicle
  double canal = 1.0;       ///< of the path's axis to the canal
  double endplates = 0.5;   ///< of the path's axis to the nearer endplate
  double density = 0.5;     ///< of the bone along the screw
  double along_axis = 1.0;  ///< how little the path is turned from its reference: see Trajectory
  double alike = 0.35;      ///< so much may both sides' paths lose together for one size of screw
  double approach = 1.0;    ///< how little the tool cuts behind its entry, and how flat the bone is there
  double fixation = 0.25;   ///< pull-out strength of the screw
};

/// How a straight way through a pedicle is found.
enum class Technique {
  pedicle,    ///< all in the pedicle
  in_out_in,  ///< thoracic: through the transverse process, out at the pedicle's side beside the rib, into the body
  cortical    ///< lumbar: from the pars upwards and outwards, along dense bone
};
/// "pedicle", "in-out-in", "cortical": names and what they stand for.
const std::map<std::string, Technique>& techniques();
const std::string& name_of(Technique technique);

/// What a path through a pedicle is wanted to run along, seen from the side.
enum class SagittalReference {
  anatomic,         ///< the pedicle's axis
  straight_forward  ///< the upper endplate
};
/// "anatomic" and "straight-forward".
const std::map<std::string, SagittalReference>& sagittal_references();

/// What suggest_paths() looks for.
struct SuggestOptions {
  double margin_mm = 1.0;          ///< of bone around the screw, from the entry opening to its tip
  double min_margin_mm = 0.0;      ///< to which it may be lessened in narrow pedicles, step by step; at most margin_mm
  double front_margin_mm = 5.0;    ///< of bone left ahead of the tip
  double widest_share = 0.8;       ///< of the pedicle's width that a screw may fill; more with a lessened margin
  double furthest_share = 0.8;     ///< of the body's depth that the tip may reach
  double max_turn_deg = 16.0;      ///< between the path and the pedicle's axis, to each side
  double lateral_breach_mm = 4.0;  ///< that an in-out-in screw may stand out at the pedicle's side
  double max_back_out_mm = 4.0;    ///< a screw may stand out of its hole so that its head is clear
  bool is_bicortical = false;      ///< the tip goes to the far cortex, not through it
  SagittalReference sagittal = SagittalReference::anatomic;
  Level level = Level::kNone;               ///< of the vertebra: which techniques there are for it
  std::optional<Technique> technique = {};  ///< only this one
  DrillBit bit;                             ///< for the hole
  SuggestWeights weights;
  GradeOptions grade;
};

/// What suggestions follow from, with tables and models from files: Bone::suggest().
struct AutoPlanOptions {
  std::filesystem::path screws = {};  ///< table of sizes; empty: the shipped screws/pedicle.json
  std::filesystem::path rules = {};   ///< margins and weights; empty: the shipped planning/pedicle.json
  /// Of bone around the screw: this and no less; nothing: that of the rules, less in narrow pedicles.
  std::optional<double> margin_mm = {};
  bool is_bicortical = false;  ///< see SuggestOptions, as the next four
  SagittalReference sagittal = SagittalReference::anatomic;
  std::optional<Technique> technique = {};
  Level level = Level::kNone;           ///< kNone: Bone::suggest() takes the bone's own
  DrillBit bit = {};                    ///< for the holes
  std::filesystem::path density = {};   ///< calibration; empty: the shipped densities/vertebra.json
  std::filesystem::path material = {};  ///< cutting model; empty: the shipped materials/vertebra.json
};

/// How far a path's entry (the whole path is shifted) and its direction (turned about the entry) may be off until the
/// screw breaches the bone, each on its own.
struct SafeZone {
  double medial_mm = 0.0, lateral_mm = 0.0, cranial_mm = 0.0, caudal_mm = 0.0;
  double medial_deg = 0.0, lateral_deg = 0.0, cranial_deg = 0.0, caudal_deg = 0.0;
};

/// A path that was found, its grade, and why this one.
struct SuggestedPath {
  DrillPath path;  ///< with its screw; shorter than it where that is backed out
  PathGrade grade;
  SafeZone safe;
  double score = 0.0;  ///< sum of weights times terms
  PathAngles angles;   ///< to the vertebra's own planes
  Technique technique = Technique::pedicle;
  double margin_mm = 0.0;  ///< that it was looked for with
  std::size_t trajectories_tried = 0;
  /// For this one and no other, a sentence each without a full stop; of a screw that fills less than 60 % of its
  /// pedicle's width also why it is no thicker.
  std::vector<std::string> reasons;
};

/// A side's path, or why there is none.
struct Suggestion {
  std::string side;  ///< "left" or "right", the patient's
  std::optional<SuggestedPath> best;
  std::vector<SuggestedPath>
      others;  ///< the next best, for a rod; without safe zones, with reasons of thin screws alone
  std::string rejection;
};

/// For each side the path through the pedicle and the screw of the table that are worth most among those that keep the
/// margins. Ways go through a lattice of places of the isthmus in a lattice of directions about the pedicle's axis; the
/// best are refined, and graded in full. Where none is of grade A the margin is lessened in steps; then another
/// technique of the level is tried, or what breaches least is taken, as its grade and reasons say. Screws of both sides
/// are made alike where that costs little. Throws Error without screws or on margins without sense.
std::vector<Suggestion> suggest_paths(const WallDistance& walls, const HuSampler& hu, const Material& material,
                                      std::span<const PedicleScrew> screws, const SuggestOptions& options = {},
                                      const Progress& progress = {});

/// Works out the safe zone of a path with a screw of grade A; all 0 for any other.
SafeZone safe_zone(const WallDistance& walls, const DrillPath& path);

/// The paths among suggestions. Throws Error that says why there is none, where there is none.
std::vector<DrillPath> paths_of(const std::vector<Suggestion>& suggestions);

}  // namespace spinaltap
