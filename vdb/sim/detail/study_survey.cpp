#include "vdb/sim/detail/study_survey.h"

#include <fstream>
#include <optional>
#include <string>

#include "core/base/code_fingerprint.h"
#include "core/base/error.h"
#include "core/base/hash.h"
#include "core/base/version.h"
#include "core/files/bone_survey_file.h"
#include "core/files/plan_file.h"
#include "core/tool/plate.h"
#include "vdb/sim/auto_plan.h"
#include "vdb/sim/bone.h"
#include "vdb/sim/bone_identity.h"
#include "vdb/sim/bone_path.h"

namespace spinaltap::detail {
namespace {

/// All that a survey follows from. Texts count with their lengths, so that no two lists of them are one.
class SurveyKey {
 public:
  void add(std::string_view text) {
    add_size(text.size());
    hash_.add(text.data(), text.size());
  }
  /// A file's content; false where it cannot be read.
  bool add_file(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string buffer(std::size_t{1} << 20, '\0');
    std::size_t size = 0;
    while (stream) {
      stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
      const auto got = static_cast<std::size_t>(stream.gcount());
      hash_.add(buffer.data(), got);
      size += got;
    }
    add_size(size);
    return stream.eof() && size > 0;
  }
  std::string hex() const { return hash_.hex(); }

 private:
  void add_size(std::uint64_t size) { hash_.add(&size, sizeof size); }

  WordHash64 hash_;
};

/// Empty where a file cannot be read: whoever loads it says why.
std::string key_of(const StudyBone& bone, const StudySpec& spec) {
  SurveyKey key;
  for (const std::string_view text :
       {std::string_view(version()), std::string_view(code_fingerprint(CodeStage::drilling)),
        std::string_view(spec.errors ? "errors" : ""), std::string_view(spec.from_the_front ? "from the front" : "")}) {
    key.add(text);
  }
  key.add(level_name(bone.level));
  key.add(bone.paths.empty() ? "" : plan_text(bone.paths));
  bool is_whole = key.add_file(bone.file);
  if (bone.paths.empty()) {
    for (const std::filesystem::path& file : files_of(AutoPlanOptions{})) is_whole = key.add_file(file) && is_whole;
  }
  return is_whole ? key.hex() : "";
}

/// Suggested paths as a file gives them back, whether they come from one or not.
std::vector<DrillPath> suggested_paths(const Bone& bone, const Progress& progress) {
  return paths_of_text(plan_text(paths_of(bone.suggest({}, progress))), "the suggested paths");
}

void survey(StudyBone& of, const StudySpec& spec, const Progress& progress) {
  const Bone bone = Bone::load(of.file, of.level);
  of.hash = bone.hash();
  of.identity = bone.identity();
  of.neighbours.clear();
  for (const Bone& other : bone.neighbours()) of.neighbours.push_back(other.hash());
  if (bone.level() != Level::kNone) of.level = bone.level();
  of.faults.clear();
  for (const DrillPath& path : of.paths) {
    const PathCheck check = check_path_on_bone(bone, path, {.from_the_front = spec.from_the_front});
    if (!check.fits()) of.faults.push_back(check.words(path));
  }
  if (of.paths.empty()) of.paths = suggested_paths(bone, progress);
  of.frames.clear();
  for (const DrillPath& path : of.paths) {
    check_straight(path, "a study");
    check_turns(path.bit, "a study");
    if (spec.errors) of.frames.push_back(error_frame(bone.landmarks(progress), path));
  }
}

/// Throws Error where a plan, or the registration, names another bone.
void check_is_of(const StudySpec& spec, const StudyBone& bone) {
  const std::string remedy = R"(, or "takes_other_ct": true in the study's file to take it all the same)";
  for (const DrillPath& path : bone.paths) check_path_is_of(path, bone.identity, remedy);
  if (spec.registration) check_same_bone("the study's registration", spec.registration->bone, bone.identity, remedy);
}

}  // namespace

std::vector<std::string> survey_bones(StudySpec& spec, const std::filesystem::path& known_in,
                                      const Progress& progress) {
  std::vector<std::string> keys;
  for (std::size_t n = 0; n < spec.bones.size(); ++n) {
    StudyBone& of = spec.bones[n];
    progress.report("bones", static_cast<double>(n) / static_cast<double>(spec.bones.size()));
    const StudyBone asked = of;
    std::string key = key_of(asked, spec);
    std::optional<StudyBone> known;
    if (!known_in.empty() && !key.empty()) known = find_survey(known_in, key, of);
    if (known) {
      of = *known;
    } else {
      survey(of, spec, progress);
      if (key != key_of(asked, spec)) key.clear();
    }
    if (!spec.takes_other_ct) check_is_of(spec, of);
    keys.push_back(std::move(key));
  }
  return keys;
}

void keep_surveys(const StudySpec& spec, const std::vector<std::string>& keys, const std::filesystem::path& folder) {
  try {
    for (std::size_t n = 0; n < keys.size(); ++n) {
      if (keys[n].empty() || find_survey(folder, keys[n], spec.bones[n])) continue;
      keep_survey(folder, keys[n], spec.bones[n]);
    }
  } catch (const Error&) {  // the runs do not depend on it
  } catch (const std::filesystem::filesystem_error&) {
  }
}

}  // namespace spinaltap::detail
