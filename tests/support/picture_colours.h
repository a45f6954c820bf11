#pragma once

#include <array>
#include <cstddef>

#include "core/base/image.h"

namespace spinaltap::test {

/// Red, green and blue of a pixel, counted from the upper left corner.
inline std::array<int, 3> pixel_colour(const Image& image, int x, int y) {
  const std::size_t at =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

inline bool is_white(const std::array<int, 3>& colour) { return colour == std::array<int, 3>{255, 255, 255}; }

}  // namespace spinaltap::test
