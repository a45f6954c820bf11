#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/plan/grade.h"
#include "core/plan/path_side.h"

namespace spinaltap {

/// What a good path is worth. Each term runs from 0 to 1; docs/planning.md has them.
struct SuggestWeights {
  double length = 1.0;      ///< how far into the body the tip comes
  double diameter = 2.0;    ///< of the screw, against the widest that is allowed
  double clearance = 1.5;   ///< of the path's axis to any surface, on its way through the pedicle
  double canal = 1.0;       ///< of the path's axis to the canal
  double endplates = 0.5;   ///< of the path's axis to the nearer endplate
  double density = 0.5;     ///< of the bone along the screw
  double along_axis = 1.0;  ///< how little the path is turned from the pedicle's axis
};

struct SuggestOptions {
  double margin_mm = 1.0;        ///< of bone around the screw, from the entry opening to its tip
  double front_margin_mm = 5.0;  ///< of bone left ahead of the tip
  double widest_share = 0.8;     ///< of the pedicle's width that a screw may fill
  double furthest_share = 0.8;   ///< of the body's depth that the tip may reach
  double max_turn_deg = 16.0;    ///< between the path and the pedicle's axis, to each side
  DrillBit bit;                  ///< for the hole
  SuggestWeights weights;
  GradeOptions grade;
};

/// How far a path's entry (the whole path is shifted) and its direction (turned about the entry) may be off until the
/// screw breaches the bone, each on its own.
struct SafeZone {
  double medial_mm = 0.0, lateral_mm = 0.0, cranial_mm = 0.0, caudal_mm = 0.0;
  double medial_deg = 0.0, lateral_deg = 0.0, cranial_deg = 0.0, caudal_deg = 0.0;
};

struct SuggestedPath {
  DrillPath path;  ///< with its screw
  PathGrade grade;
  SafeZone safe;
  double score = 0.0;  ///< sum of weights times terms
  PathAngles angles;   ///< to the vertebra's own planes
  std::size_t trajectories_tried = 0;
};

/// A side's path, or why there is none.
struct Suggestion {
  std::string side;  ///< "left" or "right", the patient's
  std::optional<SuggestedPath> best;
  std::string rejection;
};

/// For each side the path through the pedicle and the screw of the table that are worth most among those that keep the
/// margins. Ways go through a lattice of places of the isthmus in a lattice of directions about the pedicle's axis; the
/// best are refined, and graded in full. Throws Error without screws or on margins without sense.
std::vector<Suggestion> suggest_paths(const WallDistance& walls, const HuSampler& hu, const Material& material,
                                      std::span<const PedicleScrew> screws, const SuggestOptions& options = {},
                                      const Progress& progress = {});

/// Works out the safe zone of a path with a screw of grade A; all 0 for any other.
SafeZone safe_zone(const WallDistance& walls, const DrillPath& path);

}  // namespace spinaltap
