#include "apps/spinaltap-planner/slices/slice_image.h"

#include <algorithm>
#include <array>

#include "apps/report/level_slices.h"
#include "apps/spinaltap-planner/window/words.h"

namespace spinaltap {
namespace {

bool is_same_frame(const SliceFrame& a, const SliceFrame& b) {
  return a.origin_mm == b.origin_mm && a.right == b.right && a.down == b.down && a.pixel_mm == b.pixel_mm &&
         a.width == b.width && a.height == b.height;
}

}  // namespace

const QImage& SliceImage::of(const SliceSource& source, const SliceFrame& frame, const HuWindow& window) {
  const bool is_same_window = window.width_hu == window_.width_hu && window.level_hu == window_.level_hu;
  if (source == source_ && is_same_window && is_same_frame(frame, slice_.frame)) return image_;
  source_ = source;
  window_ = window;
  slice_ = ct_slice(source.bone->ct, frame, window);
  names_.clear();
  if (source.levels) draw_levels(*source.levels);
  image_ = QImage(slice_.image.rgb.data(), frame.width, frame.height, 3 * frame.width, QImage::Format_RGB888);
  return image_;
}

void SliceImage::draw_levels(const SpineSegmentation& levels) {
  constexpr int kMinPixels = 60;  // less is a corner of a bone that is not looked at
  const SliceFrame& frame = slice_.frame;
  const LabelPixels pixels{frame.width, frame.height, labels_on(levels.labels, flat(frame))};
  struct Seen {
    int pixels = 0;
    int left = 0;       ///< column
    double rows = 0.0;  ///< their sum
  };
  std::array<Seen, 256> seen{};
  for (int row = 0; row < frame.height; ++row) {
    for (int column = 0; column < frame.width; ++column) {
      const int label = pixels.at(column, row);
      if (label <= 0) continue;
      Seen& one = seen[static_cast<std::size_t>(label)];
      one.left = one.pixels == 0 ? column : std::min(one.left, column);
      ++one.pixels;
      one.rows += row;
    }
  }
  for (std::size_t n = 0; n < levels.levels.size(); ++n) {
    const LevelReport& level = levels.levels[n];
    const Seen& one = seen[static_cast<std::size_t>(level.label)];
    if (one.pixels == 0) continue;
    const Colour colour = level_colour(n);
    draw_label_outline(slice_.image, pixels, level.label, colour, level.is_suspect());
    if (one.pixels < kMinPixels) continue;
    constexpr double kBesidePx = 5.0;
    names_.push_back(
        {text_of(level.name), QColor(colour[0], colour[1], colour[2]), {one.left - kBesidePx, one.rows / one.pixels}});
  }
}

}  // namespace spinaltap
