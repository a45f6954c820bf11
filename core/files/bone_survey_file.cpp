#include "core/files/bone_survey_file.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/error.h"
#include "core/base/hash.h"
#include "core/files/detail/tool_json.h"
#include "core/files/json_file.h"

namespace spinaltap {
namespace {

constexpr FileFormat kSurveyFormat{"spinaltap-bone-survey", "survey of a bone", "delete it"};

std::filesystem::path survey_file(const std::filesystem::path& folder, const std::string& key) {
  return folder / ("bone-" + key + ".json");
}

std::string check_of(const std::string& key, const Json& survey) {
  const std::string text = key + survey.dump();
  WordHash64 hash;
  hash.add(text.data(), text.size());
  return hash.hex();
}

StudyBone read_survey(const std::filesystem::path& file, const std::string& key, StudyBone bone) {
  const Json json = read_json(file);
  check_format(json, kSurveyFormat, file);
  const JsonObject object(json, file);
  const Json& survey = object.at("survey");
  if (object.text("check") != check_of(key, survey)) fail("expected ", file.string(), " as it was written");
  const JsonObject of(survey, file);
  bone.hash = of.text("hash");
  bone.neighbours = of.at("neighbours").get<std::vector<std::string>>();
  bone.faults = of.at("faults").get<std::vector<std::string>>();
  bone.level = level_from_name(of.text("level")).value_or(Level::kNone);
  bone.identity = {of.text("ct"), bone.level};
  if (bone.paths.empty()) {
    for (const Json& path : of.at("paths")) bone.paths.push_back(read_path(path, file));
  }
  bone.frames.clear();
  for (const Json& item : of.at("frames")) {
    const JsonObject frame(item, file);
    bone.frames.push_back({frame.vector("medial"), frame.vector("cranial"), frame.vector("along")});
  }
  return bone;
}

}  // namespace

std::optional<StudyBone> find_survey(const std::filesystem::path& folder, const std::string& key,
                                     const StudyBone& bone) {
  const std::filesystem::path file = survey_file(folder, key);
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return std::nullopt;
  try {
    return read_survey(file, key, bone);
  } catch (const Error&) {
    return std::nullopt;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

void keep_survey(const std::filesystem::path& folder, const std::string& key, const StudyBone& bone) {
  Json paths = Json::array(), frames = Json::array();
  for (const DrillPath& path : bone.paths) paths.push_back(to_json(path));
  for (const ErrorFrame& frame : bone.frames) {
    frames.push_back(
        {{"medial", to_json(frame.medial)}, {"cranial", to_json(frame.cranial)}, {"along", to_json(frame.along)}});
  }
  Json survey{{"hash", bone.hash},
              {"ct", bone.identity.ct_hash},
              {"faults", bone.faults},
              {"neighbours", bone.neighbours},
              {"level", level_name(bone.level)},
              {"paths", std::move(paths)},
              {"frames", std::move(frames)}};
  Json json = format_head(kSurveyFormat);
  json["check"] = check_of(key, survey);
  json["survey"] = std::move(survey);
  write_json(json, survey_file(folder, key));
}

}  // namespace spinaltap
