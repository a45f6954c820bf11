#include "core/files/recorded_setup.h"

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/version.h"
#include "core/files/detail/session_json.h"

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

}  // namespace spinaltap
