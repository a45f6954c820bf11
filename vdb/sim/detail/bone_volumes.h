#pragma once

#include <vector>

#include "core/base/scalar_field.h"
#include "core/points/point_volume.h"
#include "core/tool/drill_path.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// Where the points of a path's volume are finer.
struct FineSpacing {
  double spacing_mm = 0.0;  ///< 0: the same spacing everywhere
  double near_mm = 1.0;     ///< of the bone's surface, along the path
  double tip_mm = 0.0;      ///< before the target
};

/// What fill_volume() asks. `exact` decides which points are bone, in place of the bone's grid, where it is given. Both
/// must outlive the sampler.
BoneSampler sampler_of(const BoneModel& bone, const ScalarField* exact = nullptr);

/// One volume along the path, or several end to end where it is finer in places. Every point is occupied, of 0 HU.
std::vector<PointVolume> volumes_along(const BoneModel& bone, const DrillPath& path, const PointVolumeOptions& options,
                                       const FineSpacing& fine);

}  // namespace spinaltap
