#pragma once

#include "core/segment/segment_spine.h"

namespace spinaltap::test {

/// CT numbers at a vertebra's surface and in its body, HU. Where a mask grew into soft tissue the surface's inside is
/// dark, where it lost a rim of bone its outside is bright.
struct MaskRim {
  double inside_hu = 0.0;   ///< median of the surface's voxels
  double outside_hu = 0.0;  ///< median of what lies at least 1 mm beyond them along the CT's axes
  double inner_hu = 0.0;    ///< mean in the middle of the body, where it is the vertebra's
};

/// Zeros where the label is not in the map.
MaskRim measure_rim(const CtVolume& ct, const LabelVolume& labels, const LevelReport& level);

}  // namespace spinaltap::test
