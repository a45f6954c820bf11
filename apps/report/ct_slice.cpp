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
  tbb::parallel_for(0, frame.height, [&](int row) {
    std::uint8_t* out = slice.image.rgb.data() + 3 * width * static_cast<std::size_t>(row);
    for (int column = 0; column < frame.width; ++column, out += 3) {
      const double hu = sample_hu(ct, frame.to_patient(Vec3(column, row, 0.0)), outside_hu);
      const double grey = std::clamp(255.0 * (hu - black_hu) / window.width_hu, 0.0, 255.0);
      std::fill_n(out, 3, static_cast<std::uint8_t>(std::lround(grey)));
    }
  });
  return slice;
}

}  // namespace spinaltap
