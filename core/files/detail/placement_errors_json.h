#pragma once

#include <filesystem>

#include "core/files/json_file.h"
#include "core/uncertainty/placement_errors.h"

namespace spinaltap {

/// A model as its numbers, as placement_errors_in() reads it again: published figures are turned into a law by then.
Json to_json(const PlacementErrors& errors);

/// As read_placement_errors(), of an object without a head. `file`: beside which its table lies, and in complaints.
PlacementErrors placement_errors_in(const Json& json, const std::filesystem::path& file);

}  // namespace spinaltap
