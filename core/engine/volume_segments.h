#pragma once

#include <vector>

#include "core/engine/drill_engine.h"
#include "core/points/point_volume.h"

namespace spinaltap {

/// A stretch of a path with a spacing of its own.
struct VolumeSegment {
  double begin_mm = 0.0;  ///< beyond the entry; negative: before it
  double end_mm = 0.0;
  double spacing_mm = 0.1;
};

/// Point volumes end to end along one path, each with its own spacing: many points where detail is wanted, few
/// elsewhere (the paper's section 10). Options give all but the spacing; the first segment's start takes the place of
/// the lead-in. Throws Error where segments are empty or do not follow one upon the other.
std::vector<PointVolume> make_segments(const DrillPath& path, const std::vector<VolumeSegment>& segments,
                                       const PointVolumeOptions& options);

/// Segments that are fine within `near_mm` of every depth at which the path's axis passes the bone's surface, and over
/// the last `tip_mm` before the target; coarse elsewhere. From `lead_in_mm` before the entry to the target.
std::vector<VolumeSegment> fine_near_surface(const DrillPath& path, double lead_in_mm, const BoneSampler& bone,
                                             double near_mm, double tip_mm, double fine_mm, double coarse_mm);

/// One bit in several volumes, whose occupied points no two share; the sums of what its engines do, which all advance
/// by the same way. Throws Error without any engine.
std::unique_ptr<DrillEngine> make_joint_engine(std::vector<std::unique_ptr<DrillEngine>> engines);

}  // namespace spinaltap
