#include "core/segment/detail/refine_mask.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/segment/detail/connected_parts.h"
#include "core/segment/distance_transform.h"
#include "core/segment/vertebra_markers.h"

namespace spinaltap {
namespace {

using Mask = std::vector<std::uint8_t>;

/// The box of CT voxels that bins with the vertebra cover, and one bin around it, within the binned box.
VoxelBox fine_box(const BinnedVertebra& binned) {
  const VoxelBox bins_used = mask_box({binned.geometry, binned.mine});
  VoxelBox fine;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int first = binned.box.low[axis] + (bins_used.low[axis] - 1) * binned.bins[axis];
    const int last = binned.box.low[axis] + (bins_used.high[axis] + 2) * binned.bins[axis] - 1;
    fine.low[axis] = std::max(first, binned.box.low[axis]);
    fine.high[axis] = std::min(last, binned.box.high[axis]);
  }
  return fine;
}

}  // namespace

RefinedMask refine_mask(const BinnedVertebra& binned, const CtVolume& ct, const BoneLevels& levels) {
  if (mask_box({binned.geometry, binned.mine}).empty()) return {};
  const VoxelBox box = fine_box(binned);
  Mask other(binned.mine.size());
  Mask not_mine(binned.mine.size());
  for (std::size_t v = 0; v < other.size(); ++v) {
    not_mine[v] = binned.mine[v] == 0 ? 1 : 0;
    other[v] = not_mine[v] != 0 && binned.bone[v] != 0 ? 1 : 0;
  }
  const double bin_mm = 1.01 * binned.geometry.spacing_mm.maxCoeff();
  const auto one_bin = static_cast<float>(bin_mm * bin_mm);
  const std::vector<float> to_mine = squared_distance_within(binned.mine, binned.geometry, bin_mm);
  const std::vector<float> to_other = squared_distance_within(other, binned.geometry, bin_mm);
  const std::vector<float> to_outside = squared_distance_within(not_mine, binned.geometry, bin_mm);
  const BoneEdge edge(ct.geometry);
  const bool is_fine = binned.bins != std::array<int, 3>{1, 1, 1};

  const FloatGrid hu = blurred_as_asked(crop_hu(ct, box), levels, ct);
  Mask inside(hu.values.size(), 0);
  Mask deep(hu.values.size(), 0);
  tbb::parallel_for(0, hu.geometry.size[2], [&](int k) {
    for (int j = 0; j < hu.geometry.size[1]; ++j) {
      for (int i = 0; i < hu.geometry.size[0]; ++i) {
        const auto bin = [&](int index, std::size_t axis) {
          return (box.low[axis] + index - binned.box.low[axis]) / binned.bins[axis];
        };
        const std::size_t coarse = binned.geometry.offset(bin(i, 0), bin(j, 1), bin(k, 2));
        const std::size_t voxel = hu.geometry.offset(i, j, k);
        const bool is_deep = binned.mine[coarse] != 0 && to_outside[coarse] > one_bin;
        const bool is_bone =
            hu.values[voxel] >= std::max(static_cast<float>(levels.low_hu), edge.hu(binned.peak_hu[coarse]));
        const bool is_near = to_mine[coarse] <= one_bin && to_mine[coarse] < to_other[coarse];
        const bool in_body = binned.mine[coarse] != 0 && binned.depth_mm[coarse] > kSureDepthMm;
        deep[voxel] = is_deep ? 1 : 0;
        inside[voxel] = is_fine ? (is_deep || in_body || (is_near && is_bone)) : binned.mine[coarse] != 0;
      }
    }
  });
  if (is_fine) inside = fill_hollows(parts_that_touch(inside, deep, hu.geometry), hu.geometry, 0.0);
  return {box, std::move(inside)};
}

}  // namespace spinaltap
