#include "apps/report/view_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/report/slice_marks.h"

namespace spinaltap {
namespace {

std::uint8_t byte_of(double share) { return static_cast<std::uint8_t>(std::lround(255.0 * share)); }

}  // namespace

Image view_picture(const View& view) {
  constexpr std::array<Colour, 4> kSeen{kWhite, Colour{214, 200, 172}, Colour{196, 54, 44}, Colour{60, 104, 168}};
  constexpr double kNearest = 0.95;
  constexpr double kFurthest = 0.15;
  double near_mm = 0.0;
  double far_mm = 0.0;
  for (const float one : view.depth_mm) {
    const auto depth_mm = static_cast<double>(one);
    if (depth_mm == 0.0) continue;
    near_mm = near_mm == 0.0 ? depth_mm : std::min(near_mm, depth_mm);
    far_mm = std::max(far_mm, depth_mm);
  }
  const int width = view.camera.width;
  Image image{3 * width, view.camera.height, {}};
  image.rgb.resize(9 * view.mask.size());
  for (int row = 0; row < view.camera.height; ++row) {
    for (int column = 0; column < width; ++column) {
      const std::size_t pixel = view.pixel(column, row);
      std::array<Colour, 3> panes{kWhite, kWhite, kSeen[view.mask[pixel]]};
      if (view.mask[pixel] != 0) {
        const double share = (static_cast<double>(view.depth_mm[pixel]) - near_mm) / std::max(far_mm - near_mm, 1e-9);
        panes[0].fill(byte_of(kNearest + share * (kFurthest - kNearest)));
        for (std::size_t axis = 0; axis < 3; ++axis) {
          panes[1][axis] = byte_of(0.5 + 0.5 * static_cast<double>(view.normals[3 * pixel + axis]));
        }
      }
      for (std::size_t pane = 0; pane < 3; ++pane) {
        const std::size_t at = 3 * static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                               pane * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
        std::copy(panes[pane].begin(), panes[pane].end(), image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * at));
      }
    }
  }
  return image;
}

}  // namespace spinaltap
