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

/// The edge of a bone is where the CT number has fallen to this, HU: the blur spreads beyond it. Of a wall that reaches
/// the full CT number of cortex somewhat under half of its peak, which gives meshes of real vertebrae their volume
/// back. A wall thinner than the blur does not reach it, and its edge lies the nearer to its peak the lower that is;
/// not so in voxels finer than walls, which show them as they are, and less in thick ones, which dilute the peak
/// itself.
class BoneEdge {
 public:
  explicit BoneEdge(const GridGeometry& ct) {
    constexpr double kFineMm = 0.8, kCoarseMm = 1.0, kThinMm = 1.6, kThickMm = 2.5;
    const double voxel_mm = ct.spacing_mm.maxCoeff();
    more_of_thin_ = 0.35 * (std::clamp((voxel_mm - kFineMm) / (kCoarseMm - kFineMm), 0.0, 1.0) *
                            std::clamp((kThickMm - voxel_mm) / (kThickMm - kThinMm), 0.0, 1.0));
  }

  float hu(float peak_hu) const {
    constexpr double kCortexHu = 1200.0;  // more is no measure: metal
    const double peak = std::min<double>(peak_hu, kCortexHu);
    return static_cast<float>((0.45 + more_of_thin_ * (1.0 - peak / kCortexHu)) * peak);
  }

 private:
  double more_of_thin_ = 0.0;  ///< share of the peak that is added as the peak goes to 0
};

/// Voxels of a box of the CT: 1 in the vertebra, 0 elsewhere, i fastest.
struct RefinedMask {
  VoxelBox box;  ///< empty where there is nothing of it
  std::vector<std::uint8_t> inside;
};

/// The vertebra on the CT's grid. Where that is finer, the binned vertebra decides only which bone a voxel belongs to;
/// whether it is bone its own CT number decides.
RefinedMask refine_mask(const BinnedVertebra& binned, const CtVolume& ct, const BoneLevels& levels);

}  // namespace spinaltap
