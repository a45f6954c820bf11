#include "apps/spinaltap-planner/slices/slice_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "apps/report/level_slices.h"
#include "apps/spinaltap-planner/window/words.h"

namespace spinaltap {
namespace {

bool is_same_frame(const SliceFrame& a, const SliceFrame& b) {
  return a.origin_mm == b.origin_mm && a.right == b.right && a.down == b.down && a.pixel_mm == b.pixel_mm &&
         a.width == b.width && a.height == b.height;
}

/// To the left of a label, at the height of its body: where that is not in the slice, of the row of the label that is
/// nearest to it.
Eigen::Vector2d place_of_name(const LabelPixels& pixels, int label, int body_row) {
  constexpr int kHalfHeight = 6;  ///< of the words, pixels
  constexpr double kBesidePx = 5.0;
  int nearest = -1;
  std::vector<int> left(static_cast<std::size_t>(pixels.height), pixels.width);  ///< by row
  for (int row = 0; row < pixels.height; ++row) {
    const auto begin = pixels.labels.begin() + static_cast<std::ptrdiff_t>(row) * pixels.width;
    const auto first = static_cast<int>(std::find(begin, begin + pixels.width, label) - begin);
    left[static_cast<std::size_t>(row)] = first;
    if (first == pixels.width) continue;
    if (nearest < 0 || std::abs(row - body_row) < std::abs(nearest - body_row)) nearest = row;
  }
  int leftmost = pixels.width;
  for (int row = std::max(nearest - kHalfHeight, 0); row <= std::min(nearest + kHalfHeight, pixels.height - 1); ++row) {
    leftmost = std::min(leftmost, left[static_cast<std::size_t>(row)]);
  }
  return {leftmost - kBesidePx, static_cast<double>(nearest)};
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
  std::array<int, 256> counts{};
  for (const int label : pixels.labels) ++counts[static_cast<std::size_t>(std::max(label, 0))];
  for (std::size_t n = 0; n < levels.levels.size(); ++n) {
    const LevelReport& level = levels.levels[n];
    const int count = counts[static_cast<std::size_t>(level.label)];
    if (count == 0) continue;
    const Colour colour = level_colour(n);
    draw_label_outline(slice_.image, pixels, level.label, colour, level.is_suspect());
    if (count < kMinPixels) continue;
    const int body_row = static_cast<int>(std::lround(std::clamp(frame.to_pixel(level.body_centre_mm).y(), -1e6, 1e6)));
    names_.push_back(
        {text_of(level.name), QColor(colour[0], colour[1], colour[2]), place_of_name(pixels, level.label, body_row)});
  }
}

}  // namespace spinaltap
