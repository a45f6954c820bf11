#include "core/segment/detail/binned_ct.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {

VoxelBox voxels_of(const Box3& box_mm, const GridGeometry& geometry) {
  Box3 box_index;
  for (int corner = 0; corner < 8; ++corner) {
    const auto side = static_cast<Box3::CornerType>(corner);
    box_index.extend(geometry.to_index(box_mm.corner(side)));
  }
  VoxelBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    const double last = geometry.size[axis] - 1;
    box.low[axis] = static_cast<int>(std::clamp(std::floor(box_index.min()[a]), 0.0, last + 1.0));
    box.high[axis] = static_cast<int>(std::clamp(std::ceil(box_index.max()[a]), -1.0, last));
  }
  return box;
}

std::array<int, 3> bins_for(const GridGeometry& geometry, double step_mm) {
  std::array<int, 3> bins{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    bins[axis] = std::max(1, static_cast<int>(std::lround(step_mm / geometry.spacing_mm[static_cast<int>(axis)])));
  }
  return bins;
}

GridGeometry binned_geometry(const GridGeometry& fine, const VoxelBox& box, const std::array<int, 3>& bins) {
  GridGeometry geometry = fine;
  Vec3 first;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    geometry.size[axis] = (box.high[axis] - box.low[axis]) / bins[axis] + 1;
    geometry.spacing_mm[a] = fine.spacing_mm[a] * bins[axis];
    first[a] = box.low[axis] + 0.5 * (bins[axis] - 1);
  }
  geometry.origin_mm = fine.to_patient(first);
  return geometry;
}

FloatGrid bin_hu(const CtVolume& ct, const VoxelBox& box, const std::array<int, 3>& bins) {
  const GridGeometry& fine = ct.geometry;
  if (box.empty() || !fine.contains(box.low[0], box.low[1], box.low[2]) ||
      !fine.contains(box.high[0], box.high[1], box.high[2])) {
    fail("binning: expected a box of voxels within the CT");
  }
  FloatGrid grid;
  grid.geometry = binned_geometry(fine, box, bins);
  grid.values.resize(grid.geometry.voxel_count());
  tbb::parallel_for(0, grid.geometry.size[2], [&](int k) {
    const auto range = [&](int index, std::size_t axis) {
      const int start = box.low[axis] + index * bins[axis];
      return std::pair{start, std::min(start + bins[axis] - 1, box.high[axis])};
    };
    const auto [k0, k1] = range(k, 2);
    for (int j = 0; j < grid.geometry.size[1]; ++j) {
      const auto [j0, j1] = range(j, 1);
      for (int i = 0; i < grid.geometry.size[0]; ++i) {
        const auto [i0, i1] = range(i, 0);
        int sum = 0;
        for (int fk = k0; fk <= k1; ++fk) {
          for (int fj = j0; fj <= j1; ++fj) {
            for (int fi = i0; fi <= i1; ++fi) sum += ct.at(fi, fj, fk);
          }
        }
        const int count = (k1 - k0 + 1) * (j1 - j0 + 1) * (i1 - i0 + 1);
        grid.values[grid.geometry.offset(i, j, k)] = static_cast<float>(sum) / static_cast<float>(count);
      }
    }
  });
  return grid;
}

}  // namespace spinaltap
