#pragma once

#include <filesystem>
#include <string_view>

#include "core/files/json_file.h"
#include "core/study/study_spec.h"

namespace spinaltap {

/// What check_keys() says of SPEC.json.
constexpr std::string_view kStudyKey = "a key of a study";

/// The operator and the design, as SPEC.json has them.
Json to_json(const StudyOperator& tool_operator);
Json to_json(const StudyDesign& design);

/// Reads what to_json() made, and "operator" and the design's keys of SPEC.json. Throw Error that names the file and
/// the key at fault.
StudyOperator read_study_operator(const Json& json, const std::filesystem::path& file);
/// `material`: whose spread a factor may be drawn from.
StudyDesign read_study_design(const Json& json, const std::filesystem::path& file, const Material& material = {});

}  // namespace spinaltap
