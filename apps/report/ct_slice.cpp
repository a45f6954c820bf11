#include "apps/report/ct_slice.h"

#include <tbb/parallel_for.h>

#include <algorithm>
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
  // From pixel to pixel, as GridGeometry::to_index() has it.
  const GridGeometry& grid = ct.geometry;
  const Mat3 to_grid = grid.spacing_mm.cwiseInverse().asDiagonal() * grid.directions.inverse();
  const Vec3 along_row = frame.pixel_mm * (to_grid * frame.right);
  const double grey_per_hu = 255.0 / window.width_hu;
  tbb::parallel_for(0, frame.height, [&](int row) {
    std::uint8_t* out = slice.image.rgb.data() + 3 * width * static_cast<std::size_t>(row);
    const Vec3 begin = grid.to_index(frame.to_patient(Vec3(0.0, row, 0.0)));
    for (int column = 0; column < frame.width; ++column, out += 3) {
      const double hu = sample_hu_at_index(ct, begin + column * along_row, outside_hu);
      // The half makes of cutting off rounding.
      const double grey = 0.5 + std::clamp(grey_per_hu * (hu - black_hu), 0.0, 255.0);
      std::fill_n(out, 3, static_cast<std::uint8_t>(grey));
    }
  });
  return slice;
}

}  // namespace spinaltap
