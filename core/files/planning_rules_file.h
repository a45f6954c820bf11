#pragma once

#include <filesystem>

#include "core/plan/suggest.h"

namespace spinaltap {

/// Reads margins and weights like the shipped planning/pedicle.json. Throws Error that names the file and the key at
/// fault, also on keys that there are not.
SuggestOptions read_planning_rules(const std::filesystem::path& path);

}  // namespace spinaltap
