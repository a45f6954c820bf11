#include "apps/report/label_place.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace spinaltap {
namespace {

bool holds(const PixelPolygon& convex, const Eigen::Vector2d& p) {
  bool left = false;
  bool right = false;
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Eigen::Vector2d edge = convex[(i + 1) % convex.size()] - convex[i];
    const Eigen::Vector2d offset = p - convex[i];
    const double side = edge.x() * offset.y() - edge.y() * offset.x();
    left = left || side > 0.0;
    right = right || side < 0.0;
  }
  return !convex.empty() && !(left && right);
}

double area(const LabelPlacer::Rectangle& rectangle) { return rectangle.isEmpty() ? 0.0 : rectangle.volume(); }

}  // namespace

void LabelPlacer::avoid_shape(const PixelPolygon& convex) {
  Rectangle box;
  for (const Eigen::Vector2d& corner : convex) box.extend(corner);
  shapes_.push_back({convex, box});
}

double LabelPlacer::cost(const Rectangle& rectangle) const {
  double covered = 4.0 * (area(rectangle) - area(rectangle.intersection(picture_)));
  for (const Rectangle& other : taken_) covered += 2.0 * area(rectangle.intersection(other));
  constexpr int kColumns = 13;
  constexpr int kRows = 5;
  for (const Shape& shape : shapes_) {
    if (!shape.box.intersects(rectangle)) continue;
    int inside = 0;
    for (int i = 0; i < kColumns * kRows; ++i) {
      const int row = i / kColumns;
      const Eigen::Vector2d share((i % kColumns) / (kColumns - 1.0), row / (kRows - 1.0));
      inside += holds(shape.outline, rectangle.min() + share.cwiseProduct(rectangle.sizes())) ? 1 : 0;
    }
    covered += area(rectangle) * inside / (kColumns * kRows);
  }
  return covered;
}

LabelPlacer::Rectangle LabelPlacer::place(const Eigen::Vector2d& anchor, const Eigen::Vector2d& size) {
  constexpr int kDirections = 16;
  Rectangle best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const double distance : {14.0, 24.0, 36.0, 52.0, 72.0}) {
    if (best_cost <= distance) break;  // further out none is better
    for (int i = 0; i < kDirections; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kDirections;
      const Eigen::Vector2d way(std::cos(angle), std::sin(angle));
      const Eigen::Vector2d middle = anchor + distance * way + 0.5 * size.cwiseProduct(way);
      const Rectangle candidate(middle - 0.5 * size, middle + 0.5 * size);
      // A label that covers nothing but lies far away is as good as one near by that covers a little.
      const double candidate_cost = cost(candidate) + distance;
      if (candidate_cost < best_cost - 1e-6) {
        best = candidate;
        best_cost = candidate_cost;
      }
    }
  }
  avoid(best);
  return best;
}

double text_width(std::string_view text, double font_size) {
  const auto characters = std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;  // not a UTF-8 continuation
  });
  return 0.56 * font_size * static_cast<double>(characters);
}

}  // namespace spinaltap
