#pragma once

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

/// The edge of dense bone is where the CT number has fallen to this, HU: the blur spreads beyond it. Somewhat under the
/// half that a wide edge would have, since thin plates do not reach their full CT number; the share is the one that
/// gives meshes of real vertebrae their volume back.
inline float min_share_of_peak(float peak_hu) {
  constexpr float kShare = 0.45F;
  constexpr float kMaxPeakHu = 1200.0F;  // metal is no measure
  return kShare * (peak_hu < kMaxPeakHu ? peak_hu : kMaxPeakHu);
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
