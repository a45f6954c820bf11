#pragma once

#include <string_view>
#include <vector>

#include "apps/report/bit_outline.h"

namespace spinaltap {

/// Finds room for short labels in a picture, so that they cover neither each other nor what they name.
/// All lengths in the picture's drawing units.
class LabelPlacer {
 public:
  using Rectangle = Eigen::AlignedBox2d;

  explicit LabelPlacer(const Rectangle& picture) : picture_(picture) {}

  /// Labels shall not lie on this.
  void avoid(const Rectangle& rectangle) { taken_.push_back(rectangle); }
  void avoid_shape(const PixelPolygon& convex);

  /// The rectangle of a label of `size` near `anchor`, and avoids it from now on. The same calls give the same places.
  Rectangle place(const Eigen::Vector2d& anchor, const Eigen::Vector2d& size);

 private:
  double cost(const Rectangle& rectangle) const;

  Rectangle picture_;
  std::vector<Rectangle> taken_;
  struct Shape {
    PixelPolygon outline;
    Rectangle box;
  };
  std::vector<Shape> shapes_;
};

/// Width of a line of sans-serif text, estimated (no font is at hand): em times `font_size`.
double text_width(std::string_view text, double font_size);

}  // namespace spinaltap
