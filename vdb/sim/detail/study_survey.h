#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/study/study_spec.h"

namespace spinaltap::detail {

/// Reads the study's bones, and takes down what its runs and results ask of them: which level, fingerprint, paths where
/// they are to be suggested, frames of errors. What the folder of an earlier survey has of a bone's file as it is now
/// is taken from there; an empty name: from none. Gives the keys of the bones' surveys, empty where a file changed
/// meanwhile. Throws Error as Bone::load() does, where nothing can be suggested, and on a bone without landmarks where
/// the study has errors.
std::vector<std::string> survey_bones(StudySpec& spec, const std::filesystem::path& known_in, const Progress& progress);

/// Keeps those of a study's bones that are not in the folder. What cannot be written is worked out again another time.
void keep_surveys(const StudySpec& spec, const std::vector<std::string>& keys, const std::filesystem::path& folder);

}  // namespace spinaltap::detail
