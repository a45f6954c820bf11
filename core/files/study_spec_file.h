#pragma once

#include <filesystem>
#include <string>

#include "core/files/detail/study_json.h"
#include "core/ct/level.h"
#include "core/drill/drill_path.h"
#include "core/drill/material.h"
#include "core/drill/point_volume.h"
#include "core/sim/drill_session.h"

namespace spinaltap {

/// What a study is: SPEC.json, read and checked. docs/studies.md has its keys.
struct StudySpec {
  std::string name;
  std::filesystem::path bone_file;
  Level level = Level::kNone;  ///< which bone of a file of several
  DrillPath path;
  Material material;
  /// Of the cylinder around the planned path that every run drills in; a radius of 0: as wide as the runs need.
  PointVolumeOptions volume{.radius_mm = 0.0, .spacing_mm = 0.1, .lead_in_mm = 3.0};
  double lead_out_mm = 5.0;  ///< how far past the target the cylinder goes
  SessionOptions options;
  StudyHand hand;
  StudyDesign design;
};

/// Reads SPEC.json. Files that it names are looked for beside it. Throws Error that names the file and the key at
/// fault; a key that is not known is one.
StudySpec read_study_spec(const std::filesystem::path& file);

/// What factors are where they do not differ.
FactorValues base_values(const StudySpec& spec);

}  // namespace spinaltap
