#include "core/segment/detail/grey_closing.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace spinaltap {
namespace {

/// Replaces each value by the `better` one of those within `reach` voxels along one axis: of i one by one, of the
/// others a row at a time.
template <class Better>
void extreme_along(std::vector<float>& values, const GridGeometry& geometry, std::size_t axis, int reach,
                   const Better& better) {
  const std::array<std::size_t, 3> stride{1, geometry.offset(0, 1, 0), geometry.offset(0, 0, 1)};
  const auto columns = static_cast<std::size_t>(geometry.size[0]);
  std::vector<float> result = values;
  tbb::parallel_for(0, geometry.size[2], [&](int k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      const std::size_t row = geometry.offset(0, j, k);
      for (int step = 1; step <= reach; ++step) {
        const std::size_t way = static_cast<std::size_t>(step) * stride[axis];
        const std::size_t from = axis == 0 ? std::min(columns, way) : 0;  // columns that have a value so far before
        const int at = axis == 1 ? j : k;
        if (axis == 0 || at >= step) {
          for (std::size_t i = from; i < columns; ++i) {
            result[row + i] = better(result[row + i], values[row + i - way]);
          }
        }
        if (axis == 0 || at + step < geometry.size[axis]) {
          for (std::size_t i = 0; i < columns - from; ++i) {
            result[row + i] = better(result[row + i], values[row + i + way]);
          }
        }
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
