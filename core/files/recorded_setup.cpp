#include "core/files/recorded_setup.h"

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/version.h"
#include "core/files/detail/session_json.h"
#include "core/files/detail/tool_json.h"

namespace spinaltap {
namespace {

constexpr const char* kSession = "session";

}  // namespace

std::map<std::string, std::string> record_setup(const SessionSetup& setup) {
  return {{kSession, to_json(setup).dump()}, {"program", version()}};
}

SessionSetup recorded_setup(const std::map<std::string, std::string>& setup, const std::filesystem::path& file) {
  const auto session = setup.find(kSession);
  if (session == setup.end()) {
    fail("expected a record of the program's own in ", file.string(), ", found none of its setup");
  }
  return read_session_setup(parse_json(session->second, "the setup in " + file.string()), file);
}

std::string record_tool(const DrillBit& bit) { return to_json(bit).dump(); }

DrillBit recorded_tool(const RecordedTool& tool, const std::filesystem::path& file) {
  DrillBit bit = read_bit(parse_json(tool.tool, "a tool in " + file.string()), file);
  check_bit(bit);
  return bit;
}

}  // namespace spinaltap
