#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/plan/placement_errors.h"

namespace spinaltap {

/// Reads a model like the shipped errors/robot_726.json; published figures are turned into the model as
/// docs/placement-errors.md says. Throws Error that names the file and the key at fault, also on keys that there are
/// not.
PlacementErrors read_placement_errors(const std::filesystem::path& path);

/// The shipped models' names, in alphabetical order.
std::vector<std::string> placement_error_models();

/// "robot_726", any other shipped model, or "MM,DEG", as plain_errors() has them. Throws Error that lists the shipped
/// ones where it is neither.
PlacementErrors placement_errors_of(const std::string& text);

}  // namespace spinaltap
