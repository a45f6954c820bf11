#pragma once

#include <filesystem>

#include "core/study/study_spec.h"

namespace spinaltap {

/// Reads SPEC.json. Files that it names are looked for beside it. Throws Error that names the file and the key at
/// fault; a key that is not known is one.
StudySpec read_study_spec(const std::filesystem::path& file);

}  // namespace spinaltap
