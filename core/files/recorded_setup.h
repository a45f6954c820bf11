#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/session/record/session_record.h"
#include "core/session/session_setup.h"

namespace spinaltap {

/// What a record's setup holds of it: "session", this as JSON, and "program", its version. Whoever makes the operator
/// adds what it was made from.
std::map<std::string, std::string> record_setup(const SessionSetup& setup);
/// Reads it back. Throws Error where there is none, or a key of it is at fault.
SessionSetup recorded_setup(const std::map<std::string, std::string>& setup, const std::filesystem::path& file);

/// A tool as RecordedTool has it: JSON, to the last bit.
std::string record_tool(const DrillBit& bit);
/// Reads it back. Throws Error where it is at fault.
DrillBit recorded_tool(const RecordedTool& tool, const std::filesystem::path& file);

}  // namespace spinaltap
