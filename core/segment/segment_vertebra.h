#pragma once

#include <optional>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

struct SegmentOptions {
  /// A point anywhere in the body of the wanted vertebra, patient LPS, mm; by default in the largest body.
  std::optional<Vec3> seed_mm = std::nullopt;
  /// Bone is at least this dense, HU; by default chosen from the CT (see choose_bone_levels()).
  std::optional<double> threshold_hu = std::nullopt;
};

struct SegmentReport {
  Vec3 seed_mm = Vec3::Zero();     ///< given or found
  double threshold_hu = 0.0;       ///< bone is over this where it hangs together with ...
  double sure_threshold_hu = 0.0;  ///< ... voxels over this
  double noise_hu = 0.0;           ///< standard deviation in soft tissue
  Vec3 body_centre_mm = Vec3::Zero();
  Vec3 body_size_mm = Vec3::Zero();  ///< width, depth and height of the cylinder nearest to the body
  double body_fit = 0.0;             ///< share of a full wall that the body's surface has, up to 1
  double cut_area_mm2 = 0.0;         ///< area where the vertebra was cut from other bones
  std::size_t parts_dropped = 0;     ///< pieces apart from the vertebra's largest
  bool reaches_border = false;       ///< the vertebra reaches the CT's border, so part of it may be missing
};

struct Segmentation {
  BoneMask mask;  ///< on the CT's grid
  SegmentReport report;
};

/// One vertebra out of a CT, marrow filled, cut from its neighbours and ribs; see docs/segmentation.md.
///
/// Its body is found around the seed (find_vertebral_body()). Bone is what lies over a threshold, with hysteresis, and
/// what it encloses. A random walker (walk_randomly()) shares it out between the body and what cannot belong to it:
/// bodies above and below, bone too far to the side, above or below. The same CT gives the same mask at any number of
/// threads. Throws Error when the seed is outside the CT or not in a vertebral body, or there is no bone.
Segmentation segment_vertebra(const CtVolume& ct, const SegmentOptions& options = {}, const Progress& progress = {});

}  // namespace spinaltap
