#pragma once

#include <span>
#include <string>

#include "core/files/json_file.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// Prints warnings, a line each, and puts them into `figures` as `key`.
void report_warnings(const char* key, std::span<const std::string> warnings, Json& figures);
/// The same of what speaks against inputs, as "input_warnings".
void report_input_warnings(std::span<const std::string> warnings, Json& figures);
/// The same of what a bone was made of.
void report_input_warnings(const BoneModel& bone, Json& figures);

/// Those, and what whoever marked the bone thinks of it, as "bone_warnings" and "bone_severity": whatever is planned,
/// graded or drilled in it rests on that.
void report_bone_warnings(const BoneModel& bone, Json& figures);

/// Says what it means that something is in doubt, and gives the exit code. `label`: "doubtful", "suspect"; `what`:
/// that.
int say_doubt(const char* label, const std::string& what, bool accepts_warnings);
/// For commands that read the inputs themselves: says what it means that something speaks against them; nothing where
/// nothing does. Gives the exit code.
int say_input_warnings(std::span<const std::string> warnings, bool accepts_warnings);

}  // namespace spinaltap
