#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace spinaltap {

/// A map over errors to the sides: a square for each, medial to the right and cranial upward, with a mark at none.
struct SquareMap {
  double left = 0.0, top = 0.0, side = 0.0;  ///< where its squares are
  std::vector<double> errors;                ///< to both sides: two or more, ascending, evenly spaced
  std::string unit;                          ///< "mm", "°"
  /// Attributes of a square, as svg_fill() has them; empty: it is not drawn.
  std::function<std::string(std::size_t medial, std::size_t cranial)> fill;
  bool frames_none = false;  ///< the mark is the square's frame, which leaves room for a number; else a cross
};

/// SVG elements: the squares, numbers at the left and below, and what they are.
std::string square_map_svg(const SquareMap& map);

/// A square's middle, where its number may stand.
double square_x(const SquareMap& map, std::size_t medial);
double square_y(const SquareMap& map, std::size_t cranial);

}  // namespace spinaltap
