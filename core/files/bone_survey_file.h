#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/study/study_spec.h"

namespace spinaltap {

// What a study takes down of a bone before its first run, kept in a folder, so that not each of a hundred tasks finds a
// hundred patients' landmarks again. A file's name holds its key: a hash of all that the survey follows from. Files
// appear whole or not at all; one that is damaged, or another's under this name, counts as none.

/// `bone` with the level, hash and frames that were kept and, where it has no paths, those. Nothing where there are
/// none.
std::optional<StudyBone> find_survey(const std::filesystem::path& folder, const std::string& key,
                                     const StudyBone& bone);
/// Keeps a surveyed bone. Throws Error where it cannot be written.
void keep_survey(const std::filesystem::path& folder, const std::string& key, const StudyBone& bone);

}  // namespace spinaltap
