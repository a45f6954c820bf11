#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/ct/level.h"
#include "core/engine/drill_engine.h"
#include "core/points/material.h"
#include "core/points/point_volume.h"
#include "core/registration/pose_covariance.h"
#include "core/session/drill_session.h"
#include "core/study/study_design.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// Who holds the bit in a study.
struct StudyOperator {
  enum class Kind : std::uint8_t {
    feed,  ///< goes on evenly, whatever the bone
    push   ///< pushes with a force: how fast it goes follows from the bone, and it plunges at a breakthrough
  };
  Kind kind = Kind::feed;
  double feed_mm_s = 1.0;
  double step_mm = 0.01;  ///< of an operator that feeds: advance a cycle
  double push_n = 20.0;
  double rate_hz = 1000.0;     ///< of an operator that pushes: cycles a second
  double reaction_s = 0.2;     ///< as ForceControlOptions has them, and the next
  double max_push_n = 200.0;   ///< it leans on the bit up to this where it stands
  double noticed_share = 0.2;  ///< of the push
  double tremor_mm = 0.0;      ///< as Tremor has it
};

/// How the registration errs by which a study's runs are guided.
struct StudyRegistration {
  PoseCovariance covariance;
  bool is_per_run = true;  ///< each run is registered anew; otherwise all are of one patient, with one error
};

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
  /// `voxel`: voxels of the bone in the box of that cylinder, its spacing apart, in place of points.
  EngineKind engine = EngineKind::automatic;
  SessionOptions options;
  StudyOperator tool_operator;
  StudyDesign design;
  /// Moves the line that the bit really takes, beside what the design's factors do.
  std::optional<StudyRegistration> registration;
};

/// What factors are where they do not differ.
FactorValues base_values(const StudySpec& spec);

}  // namespace spinaltap
