#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/uncertainty/placement_errors.h"

namespace spinaltap {

/// Reads a model like the shipped errors/robot_726.json; published figures are turned into the model as
/// docs/placement-errors.md says. Throws Error that names the file and the key at fault, also on keys that there are
/// not.
PlacementErrors read_placement_errors(const std::filesystem::path& path);

/// Errors as they were measured, from a CSV file with a header: entry_medial_mm, entry_cranial_mm, and
/// direction_medial_deg and direction_cranial_deg, or tip_medial_mm, tip_cranial_mm and screw_length_mm; along_mm where
/// it was measured. Other columns are passed over. Throws Error that names the file and the line at fault.
std::vector<PlacementError> read_measured_errors(const std::filesystem::path& path);

/// The shipped models' names, in alphabetical order.
std::vector<std::string> placement_error_models();

/// "robot_726", any other shipped model, or "MM,DEG", as plain_errors() has them. Throws Error that lists the shipped
/// ones where it is neither.
PlacementErrors placement_errors_of(const std::string& text);

}  // namespace spinaltap
