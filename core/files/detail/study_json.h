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

/// "kind": "drilling" or "geometry"; the first where there is none.
StudyKind read_study_kind(const JsonObject& object, const std::filesystem::path& file);
/// "per": "run", "screw" or "patient"; the first where there is none.
DrawnPer read_drawn_per(const JsonObject& object, const std::filesystem::path& file);
/// A patient's number, from 1 on, as it counts inside. Throws Error on 0 and above a million.
std::size_t checked_patient(std::uint64_t number, const std::filesystem::path& file);

/// Reads what to_json() made, and "operator" and the design's keys of SPEC.json. Throw Error that names the file and
/// the key at fault.
StudyOperator read_study_operator(const Json& json, const std::filesystem::path& file);
/// `material`: whose spread a factor may be drawn from.
StudyDesign read_study_design(const Json& json, const std::filesystem::path& file, const Material& material = {});

}  // namespace spinaltap
