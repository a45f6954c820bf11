#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/segment/segment_spine.h"

namespace spinaltap {

/// The warnings of a vertebra that was found, in words, and one where its name is but a hint.
LevelWarnings warnings_of(const LevelReport& report);

/// As the metadata "severity", "warnings" (a line each) and "unsure_mm" (x y z of the first place in each cell of 2 mm,
/// to 0.1 mm) of a bone, and back; nothing where there are no such metadata.
void add_warnings(const LevelWarnings& warnings, std::map<std::string, std::string>& metadata);
std::optional<LevelWarnings> warnings_in(const std::map<std::string, std::string>& metadata);

/// What speaks against the files that a bone was made of (CtVolume::warnings, and those of its label map), as the
/// metadata "input_warnings", a line each, and back. Lines that are there already are not added again.
void add_input_warnings(std::span<const std::string> lines, std::map<std::string, std::string>& metadata);
std::vector<std::string> input_warnings_in(const std::map<std::string, std::string>& metadata);

/// What was made of the CT's numbers (CtVolume::hu_change), as the metadata "hu_scale" and "hu_offset", and in words:
/// "x 1 - 1024, as told"; nothing where nothing was.
void add_hu_change(const HuChange& change, std::map<std::string, std::string>& metadata);
std::string hu_change_in(const std::map<std::string, std::string>& metadata);

}  // namespace spinaltap
