#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/segment/bone_levels.h"
#include "core/segment/float_grid.h"

namespace spinaltap {

/// A vertebra on the binned grid it was cut out on.
struct BinnedVertebra {
  const std::vector<std::uint8_t>& mine;
  const std::vector<std::uint8_t>& bone;  ///< all bone, neighbours included
  const std::vector<float>& depth_mm;     ///< in the vertebral body
  const std::vector<float>& peak_hu;      ///< of the neighbourhood
  const GridGeometry& geometry;
  const VoxelBox& box;  ///< of the CT
  const std::array<int, 3>& bins;
};

/// The edge of dense bone is where the CT number has fallen to this, HU: the blur spreads beyond it. Somewhat over the
/// half that a wide edge would have: a wall thinner than the blur has its own edge nearer to its peak. Less in voxels
/// thicker than that, which dilute the peak itself. `voxel_mm`: the CT's largest spacing.
inline float min_share_of_peak(float peak_hu, double voxel_mm) {
  constexpr double kShare = 0.65, kShareInThick = 0.5, kThinMm = 1.6, kThickMm = 3.0;
  constexpr float kMaxPeakHu = 1200.0F;  // metal is no measure
  const double thick = std::clamp((voxel_mm - kThinMm) / (kThickMm - kThinMm), 0.0, 1.0);
  return static_cast<float>(kShare + thick * (kShareInThick - kShare)) * std::min(peak_hu, kMaxPeakHu);
}

/// Voxels of a box of the CT: 1 in the vertebra, 0 elsewhere, i fastest.
struct RefinedMask {
  VoxelBox box;  ///< empty where there is nothing of it
  std::vector<std::uint8_t> inside;
};

/// The vertebra on the CT's grid. Where that is finer, the binned vertebra decides only which bone a voxel belongs to;
/// whether it is bone its own CT number decides.
RefinedMask refine_mask(const BinnedVertebra& binned, const CtVolume& ct, const BoneLevels& levels);

}  // namespace spinaltap
