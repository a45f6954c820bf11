#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/ct/bone_identity.h"
#include "core/ct/level.h"
#include "core/engine/step_result.h"
#include "core/points/material.h"
#include "core/points/point_volume_options.h"
#include "core/registration/pose_covariance.h"
#include "core/session/session_setup.h"
#include "core/study/study_design.h"
#include "core/tool/drill_path.h"
#include "core/uncertainty/placement_errors.h"

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
  DrawnPer per = DrawnPer::run;  ///< for what the patient is registered anew
  BoneIdentity bone = {};        ///< that it is of; empty: not known
};

/// What a study's runs do.
enum class StudyKind : std::uint8_t {
  drilling,  ///< drill the hole, cycle by cycle, and grade the bit and the screw
  geometry   ///< grade the screw where it would lie: thousands a second
};

/// "drilling", "geometry".
std::string_view name_of(StudyKind kind);

/// A bone of a study, and what is planned in it.
struct StudyBone {
  std::filesystem::path file = {};
  Level level = Level::kNone;                ///< which bone of a file of several; by the time a study runs: which it is
  std::size_t patient = 0;                   ///< counts from 0: bones of one patient have one
  std::vector<DrillPath> paths = {};         ///< none: those that are suggested for it
  std::string hash = {};                     ///< of the bone; empty until it was read
  BoneIdentity identity = {};                ///< likewise: which vertebra of which CT
  std::vector<std::string> neighbours = {};  ///< hashes of the vertebrae beside it in its file, likewise
  std::vector<std::string> faults = {};      ///< of paths that do not fit the bone, likewise: PathCheck::words()
  std::vector<ErrorFrame> frames = {};       ///< of each path's errors of placement; none until the bone was read
};

/// What a study is: SPEC.json, read and checked. docs/studies.md has its keys.
struct StudySpec {
  std::string name;
  StudyKind kind = StudyKind::drilling;
  std::vector<StudyBone> bones;
  Material material;
  /// Of the cylinder around the planned path that every run drills in; a radius of 0: as wide as the runs need.
  PointVolumeOptions volume{.radius_mm = 0.0, .spacing_mm = 0.1, .lead_in_mm = 3.0};
  double lead_out_mm = 5.0;  ///< how far past the target the cylinder goes
  /// `voxel`: voxels of the bone in the box of that cylinder, its spacing apart, in place of points.
  EngineKind engine = EngineKind::automatic;
  SessionOptions options;
  StudyOperator tool_operator;
  StudyDesign design;
  /// Move the line that the bit really takes, beside what the design's factors do: how a screw errs where the patient
  /// is known, and where the patient is taken to be.
  std::optional<PlacementErrors> errors;
  std::optional<StudyRegistration> registration;
  bool from_the_front = false;  ///< paths may enter the vertebrae from their front
  bool takes_other_ct = false;  ///< plans and registration may name other bones than those: they are taken all the same
};

/// One planned screw, or hole, of a study: a path of a bone.
struct StudyScrew {
  std::size_t bone = 0;
  std::size_t path = 0;
};
/// All of them, bone after bone: numbers of screws count so.
std::vector<StudyScrew> screws_of(const StudySpec& spec);
/// One of them. Throws Error where there are not so many.
StudyScrew screw_at(const StudySpec& spec, std::size_t n);
/// Its path. The screw must be one of the spec's.
inline const DrillPath& path_of(const StudySpec& spec, const StudyScrew& screw) {
  return spec.bones[screw.bone].paths[screw.path];
}
/// What StudyRuns asks of a study whose paths are known; `registration`: for what it is drawn anew, where there is one.
StudyGround ground_of(const std::vector<StudyBone>& bones, bool has_errors, std::optional<DrawnPer> registration);
StudyGround ground_of(const StudySpec& spec);

/// What is beyond the tools' usual speeds: of the operator's feed, the spindle, and the levels and bounds of a factor
/// of feed.
std::vector<std::string> speed_warnings(const StudySpec& spec);

/// What factors are where they do not differ, along a path; not a number for those that do not apply to the study.
FactorValues base_values(const StudySpec& spec, const DrillPath& path);
/// Likewise, without a path: only which apply counts.
bool applies(const StudySpec& spec, StudyFactor factor);

}  // namespace spinaltap
