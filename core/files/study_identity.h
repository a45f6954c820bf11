#pragma once

#include <filesystem>
#include <string>

#include "core/files/study_folder.h"
#include "core/session/session_setup.h"
#include "core/study/study_spec.h"

namespace spinaltap {

/// What a study's results depend on. `spec.volume.radius_mm` must be known by now.
StudyIdentity study_identity(const StudySpec& spec, const StudyRuns& runs, const std::string& bone_hash);

/// What an identity says of its study.
struct IdentifiedStudy {
  std::string name;
  SessionSetup setup;
  StudyHand hand;
  StudyDesign design;
};

/// Reads what study_identity() made. Throws Error that names `file` and the key at fault.
IdentifiedStudy study_of(const StudyIdentity& identity, const std::filesystem::path& file);

}  // namespace spinaltap
