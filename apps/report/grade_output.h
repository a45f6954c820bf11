#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/files/json_file.h"
#include "core/plan/suggest.h"

namespace spinaltap {

/// A path and what it was graded as.
struct GradedPath {
  DrillPath path;
  PathGrade grade;
  std::optional<SafeZone> safe = {};  ///< where it was worked out
};

/// "screw 6.5 x 45 mm" or "bit of 3 mm".
std::string tool_of(const DrillPath& path);
/// "canal, medial" or "outer surface, lateral"; empty without a breach.
std::string breach_of(const PathGrade& grade);
/// "below 135 HU", "135 to 375 HU", "375 HU and above".
std::vector<std::string> band_names(const std::vector<double>& hu_bands);

/// All figures of a path, with its rows where asked. What is not finite is null.
Json to_json(const GradedPath& graded, const std::vector<double>& hu_bands, bool with_rows);
/// The rows of all paths, with a head line; units are in the names of the columns. What is not finite is empty.
std::string grades_csv(const std::vector<GradedPath>& paths, const std::vector<double>& hu_bands);
/// For a terminal: a line of each path on its walls, and one on its bone.
std::string grades_table(const std::vector<GradedPath>& paths, const std::vector<double>& hu_bands);

}  // namespace spinaltap
