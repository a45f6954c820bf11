#pragma once

#include <filesystem>
#include <vector>

#include "core/tool/drill_path.h"

namespace spinaltap {

/// Reads a table of screws like the shipped screws/pedicle.json: every diameter with every length, by rising diameter
/// and length, each named like "6.5 x 45 mm". Throws Error that names the file and the key at fault.
std::vector<PedicleScrew> read_screws(const std::filesystem::path& path);

}  // namespace spinaltap
