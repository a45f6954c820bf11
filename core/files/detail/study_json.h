#pragma once

#include <filesystem>
#include <string_view>

#include "core/files/json_file.h"
#include "core/study/study_spec.h"

namespace spinaltap {

/// What check_keys() says of SPEC.json.
constexpr std::string_view kStudyKey = "a key of a study";

/// The hand and the design, as SPEC.json has them.
Json to_json(const StudyHand& hand);
Json to_json(const StudyDesign& design);

/// Reads what to_json() made, and "hand" and the design's keys of SPEC.json. Throw Error that names the file and the
/// key at fault.
StudyHand read_study_hand(const Json& json, const std::filesystem::path& file);
StudyDesign read_study_design(const Json& json, const std::filesystem::path& file);

}  // namespace spinaltap
