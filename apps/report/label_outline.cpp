#include "apps/report/label_outline.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace spinaltap {
namespace {

/// One edge of a pixel: side 0 is its top, walked to the right, 1 its right, walked down, and so on, so that the pixel
/// lies to the right hand of the walk.
struct PixelEdge {
  int column;
  int row;
  int side;
  bool operator==(const PixelEdge&) const = default;
};

constexpr std::array<std::array<int, 2>, 4> kOutward{{{0, -1}, {1, 0}, {0, 1}, {-1, 0}}};

/// Walks around the areas of a label, edge by edge.
class OutlineWalk {
 public:
  OutlineWalk(const LabelPixels& pixels, int label) : pixels_(pixels), label_(label) {}

  bool inside(int column, int row) const {
    return column >= 0 && row >= 0 && column < pixels_.width && row < pixels_.height &&
           pixels_.at(column, row) == label_;
  }
  bool on_outline(const PixelEdge& edge) const {
    const auto [x, y] = kOutward[static_cast<std::size_t>(edge.side)];
    return inside(edge.column, edge.row) && !inside(edge.column + x, edge.row + y);
  }
  bool on_border(const PixelEdge& edge) const {
    const auto [x, y] = kOutward[static_cast<std::size_t>(edge.side)];
    const int column = edge.column + x;
    const int row = edge.row + y;
    return column < 0 || row < 0 || column >= pixels_.width || row >= pixels_.height;
  }
  /// The edge that begins where this one ends; areas that touch in a corner are walked one by one.
  PixelEdge next(const PixelEdge& edge) const {
    const auto ahead = kOutward[static_cast<std::size_t>((edge.side + 1) % 4)];
    const auto out = kOutward[static_cast<std::size_t>(edge.side)];
    const int column = edge.column + ahead[0];
    const int row = edge.row + ahead[1];
    if (!inside(column, row)) return {edge.column, edge.row, (edge.side + 1) % 4};
    if (!inside(column + out[0], row + out[1])) return {column, row, edge.side};
    return {column + out[0], row + out[1], (edge.side + 3) % 4};
  }

 private:
  const LabelPixels& pixels_;
  int label_;
};

}  // namespace

void draw_label_outline(Image& image, const LabelPixels& pixels, int label, const Colour& colour, bool dashed) {
  constexpr int kDashPixels = 9;
  constexpr int kDashPeriod = 16;
  const OutlineWalk walk(pixels, label);
  std::vector<std::uint8_t> seen(pixels.labels.size());  // a bit a side
  const auto seen_at = [&](const PixelEdge& edge) -> std::uint8_t& {
    return seen[static_cast<std::size_t>(edge.row) * static_cast<std::size_t>(pixels.width) +
                static_cast<std::size_t>(edge.column)];
  };
  for (int row = 0; row < pixels.height; ++row) {
    for (int column = 0; column < pixels.width; ++column) {
      if (pixels.at(column, row) != label) continue;
      for (int side = 0; side < 4; ++side) {
        const PixelEdge first{column, row, side};
        if (!walk.on_outline(first) || (seen_at(first) >> side & 1) != 0) continue;
        int walked = 0;
        PixelEdge edge = first;
        do {
          std::uint8_t& bits = seen_at(edge);
          bits = static_cast<std::uint8_t>(bits | 1 << edge.side);
          const bool drawn = !dashed || walked % kDashPeriod < kDashPixels;
          if (drawn && !walk.on_border(edge)) fill_rectangle(image, edge.column, edge.row, 1, 1, colour);
          edge = walk.next(edge);
          ++walked;
        } while (edge != first);
      }
    }
  }
}

}  // namespace spinaltap
