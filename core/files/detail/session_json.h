#pragma once

#include "core/files/json_file.h"
#include "core/session/session_setup.h"

namespace spinaltap {

/// Numbers are written so that they come back to the last bit; of the engine `auto`, the one that it comes to.
Json to_json(const SessionSetup& setup);
/// Throws Error that names the file and the key at fault.
SessionSetup read_session_setup(const Json& json, const std::filesystem::path& file);

/// The drilling engine under "engine". Throws Error likewise.
EngineKind read_engine(const JsonObject& object, const std::filesystem::path& file);

}  // namespace spinaltap
