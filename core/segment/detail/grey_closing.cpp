#include "core/segment/detail/grey_closing.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace spinaltap {
namespace {

/// Replaces each value by the `better` one of those within `reach` voxels along one axis.
template <class Better>
void extreme_along(std::vector<float>& values, const GridGeometry& geometry, std::size_t axis, int reach,
                   const Better& better) {
  const std::array<std::size_t, 3> stride{1, geometry.offset(0, 1, 0), geometry.offset(0, 0, 1)};
  std::vector<float> result(values.size());
  tbb::parallel_for(0, geometry.size[2], [&](int k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const std::array<int, 3> index{i, j, k};
        const std::size_t here = geometry.offset(i, j, k);
        float best = values[here];
        const int before = std::min(reach, index[axis]);
        const int after = std::min(reach, geometry.size[axis] - 1 - index[axis]);
        std::size_t at = here - static_cast<std::size_t>(before) * stride[axis];
        for (int step = -before; step <= after; ++step, at += stride[axis]) best = better(best, values[at]);
        result[here] = best;
      }
    }
  });
  values.swap(result);
}

template <class Better>
void extreme(std::vector<float>& values, const GridGeometry& geometry, double reach_mm, const Better& better) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double voxels = reach_mm / geometry.spacing_mm[static_cast<Eigen::Index>(axis)];
    extreme_along(values, geometry, axis, std::max(1, static_cast<int>(std::lround(voxels))), better);
  }
}

}  // namespace

GreyClosing close_gaps(const FloatGrid& grid, double reach_mm) {
  GreyClosing closing{grid.values, {}};
  extreme(closing.peak, grid.geometry, reach_mm, [](float a, float b) { return std::max(a, b); });
  closing.closed = closing.peak;
  extreme(closing.closed, grid.geometry, reach_mm, [](float a, float b) { return std::min(a, b); });
  return closing;
}

}  // namespace spinaltap
