#include "core/files/study_identity.h"

#include <nlohmann/json.hpp>

#include "core/base/version.h"
#include "core/files/detail/session_json.h"
#include "core/files/detail/study_json.h"

namespace spinaltap {

StudyIdentity study_identity(const StudySpec& spec, const StudyRuns& runs, const std::string& bone_hash) {
  SessionSetup setup;
  setup.bone_hash = bone_hash;
  setup.path = spec.path;
  setup.material = spec.material;
  setup.volume = spec.volume;
  setup.options = spec.options;
  const Json study{{"program", version()},       {"name", spec.name},
                   {"session", to_json(setup)},  {"lead_out_mm", spec.lead_out_mm},
                   {"hand", to_json(spec.hand)}, {"design", to_json(spec.design)}};
  return {study.dump(), runs.count()};
}

IdentifiedStudy study_of(const StudyIdentity& identity, const std::filesystem::path& file) {
  const Json json = Json::parse(identity.study);
  const JsonObject study(json, file);
  return {study.text("name"), read_session_setup(study.at("session"), file), read_study_hand(study.at("hand"), file),
          read_study_design(study.at("design"), file)};
}

}  // namespace spinaltap
