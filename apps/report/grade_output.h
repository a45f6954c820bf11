#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/files/json_file.h"
#include "core/plan/suggest.h"
#include "core/uncertainty/ct_surface_error.h"
#include "core/uncertainty/placement_probabilities.h"

namespace spinaltap {

/// The registration whose error was added to the screws' own.
struct AddedRegistration {
  std::string name;        ///< of its file
  double entry_mm = 0.0;   ///< its error at the path's entry, root mean square
  double target_mm = 0.0;  ///< and at the target
  std::vector<std::string> warnings;
};

/// What becomes of a path where screws err.
struct PlacedGrade {
  PlacementErrors errors;
  GradeProbabilities probabilities;
  BreachMap map;
  std::optional<AddedRegistration> registration = {};
};

/// A path and what it was graded as.
struct GradedPath {
  DrillPath path;
  PathGrade grade;
  std::optional<SafeZone> safe = {};           ///< where it was worked out
  std::optional<PlacedGrade> placed = {};      ///< the same
  std::optional<CtSurfaceError> surface = {};  ///< of the CT that shows the bone, where it is known
};

/// "screw 6.5 x 45 mm" or "bit of 3 mm".
std::string tool_of(const DrillPath& path);
/// "canal, medial" or "outer surface, lateral"; empty without a breach.
std::string breach_of(const PathGrade& grade);
/// "below 135 HU", "135 to 375 HU", "375 HU and above".
std::vector<std::string> band_names(const std::vector<double>& hu_bands);

/// "93 % (91 to 95)": a probability and its interval.
std::string probability_in_words(const Probability& probability);
/// Whether the path is graded as without a breach, and the surface is not known well enough to say so: the clearance's
/// 95 % band goes below 0.
bool hides_breach(const GradedPath& graded);
/// "A 93 % (91 to 95), B 6 % (5 to 8); breach into the canal 2 % (1 to 3); by robot_726, 1024 draws": grades below 0.1
/// % are left out.
std::string probabilities_in_words(const PlacedGrade& placed);
/// "robot_726", "1.5 mm, 2 degrees and registration.json (0.61 mm at the entry, 0.93 mm at the target)".
std::string errors_in_words(const PlacedGrade& placed);
/// "found to 0.12 mm (standard error), to 0.09 mm where it is nearest: clearance to the canal 1.31 mm is 1.13 to 1.49
/// mm", of the wall above which least is left for sure.
std::string surface_in_words(const GradedPath& graded);

/// Odds and map where errors are known, and how well the surface is: "placement" and "surface". Without the map only
/// figures.
Json uncertainty_json(const GradedPath& graded, bool with_map = false);
/// All figures of a path, with its rows where asked. What is not finite is null.
Json to_json(const GradedPath& graded, const std::vector<double>& hu_bands, bool with_rows);
/// The rows of all paths, with a head line; units are in the names of the columns. What is not finite is empty.
std::string grades_csv(const std::vector<GradedPath>& paths, const std::vector<double>& hu_bands);
/// For a terminal: a line of each path on its walls, on scales and instrument, and on its bone; then what was found, a
/// line each. "A, but": a warning below says what the grade leans on.
std::string grades_table(const std::vector<GradedPath>& paths, const std::vector<double>& hu_bands);

}  // namespace spinaltap
