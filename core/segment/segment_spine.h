#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/ct/label_volume.h"
#include "core/ct/level.h"
#include "core/segment/level_figures.h"

namespace spinaltap {

/// A user's word for one vertebra: a point in its body, patient LPS, mm.
struct LevelPoint {
  Level level = Level::kNone;
  Vec3 p_mm = Vec3::Zero();
};

/// A user's correction: the bone at a point (patient LPS, mm) belongs to a level, or to none of the vertebrae.
struct Correction {
  Level level = Level::kNone;  ///< kNone: it is no vertebra's
  Vec3 p_mm = Vec3::Zero();
};

/// What a user knows of a CT's vertebrae.
struct SegmentOptions {
  /// A point anywhere in the body of the wanted vertebra, patient LPS, mm. segment_vertebra() takes the largest whole
  /// one by default; segment_spine() takes the column that it lies in.
  std::optional<Vec3> seed_mm = std::nullopt;
  /// Bone is at least this dense, HU; by default chosen from the CT (see choose_bone_levels()).
  std::optional<double> threshold_hu = std::nullopt;
  /// What is known of names: the others are counted from these.
  std::vector<LevelPoint> names = {};
  std::vector<Correction> corrections = {};
};

/// Where a level's name is from.
enum class NameSource {
  given,    ///< the user's word for this vertebra or another one, counted on from there
  hint,     ///< the likeliest by the sacrum, the ribs and the sizes of bodies: voted_names()
  counted,  ///< no name is known: "V1" is the uppermost
};

/// What is known of one vertebra of a CT.
struct LevelReport {
  int label = 0;     ///< in the label map
  std::string name;  ///< "T11", or "V3" without any word or hint
  Level level = Level::kNone;
  NameSource name_source = NameSource::counted;
  std::vector<LevelProbability>
      name_probabilities{};  ///< what else it may be, the likeliest first; empty where the name was given
  Vec3 body_centre_mm = Vec3::Zero();
  Vec3 body_size_mm = Vec3::Zero();  ///< width, depth and height of the cylinder nearest to the body
  Mat3 body_axes = Mat3::Identity();
  double body_fit = 0.0;          ///< share of a full wall that the body's surface has, up to 1
  double cut_area_mm2 = 0.0;      ///< area where the vertebra was cut from other bones
  std::size_t parts_dropped = 0;  ///< pieces that hang on nothing
  double volume_mm3 = 0.0;
  bool is_cut = false;          ///< the body goes on beyond the CT
  bool reaches_border = false;  ///< the vertebra reaches the CT's border, so part of it may be missing
  LevelFigures figures;
  std::vector<LevelWarning> warnings;
  double severity = 0.0;  ///< 0 to 1, see total_severity()

  bool is_suspect() const { return severity >= kSuspect; }
};

/// What is known of the CT.
struct BoneReport {
  double threshold_hu = 0.0;       ///< bone is over this where it hangs together with ...
  double sure_threshold_hu = 0.0;  ///< ... voxels over this
  double noise_hu = 0.0;           ///< standard deviation in soft tissue
};

/// Numbers in the label maps of segment_spine() that are no vertebrae's.
inline constexpr int kRibsLabel = 50;
inline constexpr int kFirstUnnamedLabel = 101;

/// What segment_spine() finds.
struct SpineSegmentation {
  LabelVolume labels;               ///< on the CT's grid: vertebrae, sacrum, ribs
  std::vector<LevelReport> levels;  ///< vertebrae from the head down
  BoneReport bone;
  std::vector<std::string> gaps;  ///< where vertebrae may have been missed, in words: gaps_in_row()
  std::string transitional;       ///< what speaks for other numbers of vertebrae than most people have, or empty
};

/// All vertebrae of a CT, each parted from its neighbours, ribs and all other bone; see docs/segmentation.md. The same
/// CT gives the same map at any number of threads. Throws Error where there is no spine, and on points that lie in no
/// body.
SpineSegmentation segment_spine(const CtVolume& ct, const SegmentOptions& options = {}, const Progress& progress = {});

/// One vertebra of a CT.
struct Segmentation {
  BoneMask mask;  ///< on the CT's grid
  LevelReport report;
  BoneReport bone;
  Vec3 seed_mm = Vec3::Zero();  ///< given, or the body's middle
  std::string choice;           ///< which it is of those that were found: "V2 of 3 found, the largest that is whole"
};

/// One vertebra: what segment_spine() makes of it, in less time. Throws Error when the seed is outside the CT or in no
/// vertebral body, or there is no spine.
Segmentation segment_vertebra(const CtVolume& ct, const SegmentOptions& options = {}, const Progress& progress = {});

}  // namespace spinaltap
