#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace spinaltap {

/// For every disc, a circle without an occupied point, about the middle of where the bit's axis has been.
///
/// Points only die, so it stays empty: a bit that trembles in its hole, near one wall and then another, needs no look
/// at a disc as long as its own circle lies within that one.
class EmptyCircles {
 public:
  explicit EmptyCircles(std::size_t discs) : circles_(discs) {}

  /// How far from (x, y) in a disc's plane all occupied points are, at least, mm; below 0 where that is not known.
  double clear_mm(int disc, double x_mm, double y_mm) const noexcept {
    const Circle& circle = circles_[static_cast<std::size_t>(disc)];
    const double x = x_mm - circle.x_mm, y = y_mm - circle.y_mm;
    return circle.radius_mm - std::sqrt(x * x + y * y);
  }

  /// Moves the circle's middle towards one more place of the axis and sets how far all occupied points are from there:
  /// `min_distance_mm(x_mm, y_mm)`.
  template <class MinDistance>
  void renew(int disc, double x_mm, double y_mm, const MinDistance& min_distance_mm) noexcept {
    Circle& circle = circles_[static_cast<std::size_t>(disc)];
    circle.places = std::min(circle.places + 1.0, kPlaces);
    circle.x_mm += (x_mm - circle.x_mm) / circle.places;
    circle.y_mm += (y_mm - circle.y_mm) / circle.places;
    circle.radius_mm = min_distance_mm(circle.x_mm, circle.y_mm);
  }

  std::size_t memory_bytes() const { return circles_.size() * sizeof(circles_[0]); }

 private:
  /// A mean of about so many places, the last count most.
  static constexpr double kPlaces = 16.0;

  struct Circle {
    double x_mm = 0.0, y_mm = 0.0;
    double radius_mm = -std::numeric_limits<double>::infinity();
    double places = 0.0;
  };
  std::vector<Circle> circles_;
};

}  // namespace spinaltap
