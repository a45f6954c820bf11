#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace spinaltap {

/// A picture: 8-bit RGB, rows from the top, three bytes a pixel.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< width * height * 3 bytes
};

}  // namespace spinaltap
