#include "apps/report/ct_slice.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/base/error.h"

namespace spinaltap {

CtSlice ct_slice(const CtVolume& ct, const SliceFrame& frame, const HuWindow& window) {
  if (!(window.width_hu > 0.0)) fail("CT slice: expected a window wider than 0 HU, found ", window.width_hu);
  CtSlice slice{{frame.width, frame.height, {}}, frame};
  const auto width = static_cast<std::size_t>(frame.width);
  slice.image.rgb.resize(3 * width * static_cast<std::size_t>(frame.height));
  const double black_hu = window.level_hu - 0.5 * window.width_hu;
  const double outside_hu = black_hu;
  // As GridGeometry::to_index() works it out, but for the inverse, which is the same for all pixels.
  const GridGeometry& grid = ct.geometry;
  const Mat3 to_grid = grid.directions.inverse();
  tbb::parallel_for(0, frame.height, [&](int row) {
    std::uint8_t* out = slice.image.rgb.data() + 3 * width * static_cast<std::size_t>(row);
    for (int column = 0; column < frame.width; ++column, out += 3) {
      const Vec3 p_patient = frame.to_patient(Vec3(column, row, 0.0));
      const Vec3 p_index = (to_grid * (p_patient - grid.origin_mm)).cwiseQuotient(grid.spacing_mm);
      const double hu = sample_hu_at_index(ct, p_index, outside_hu);
      const double grey = std::clamp(255.0 * (hu - black_hu) / window.width_hu, 0.0, 255.0);
      std::fill_n(out, 3, static_cast<std::uint8_t>(std::lround(grey)));
    }
  });
  return slice;
}

}  // namespace spinaltap
