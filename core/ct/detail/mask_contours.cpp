// Marching squares (Lorensen & Cline's cubes in the plane) on a mask: each crossing lies half-way, so that points are
// kept as whole numbers of half pixels and lines meet exactly.

#include "core/ct/detail/mask_contours.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace spinaltap::detail {
namespace {

using HalfPoint = std::pair<int, int>;  // b first, then a: the order in which outlines begin

/// The lines of the cell whose first corner is pixel (a, b): from where the bone is left to where it was met, walking
/// around the cell. Its neighbour walks the shared side the other way, so that lines join.
void add_lines(const std::array<bool, 4>& inside, int a, int b, std::map<HalfPoint, HalfPoint>& next) {
  const std::array<HalfPoint, 4> sides{HalfPoint{2 * b, 2 * a + 1}, HalfPoint{2 * b + 1, 2 * a + 2},
                                       HalfPoint{2 * b + 2, 2 * a + 1}, HalfPoint{2 * b + 1, 2 * a}};
  for (std::size_t side = 0; side < 4; ++side) {
    if (!inside[side] || inside[(side + 1) % 4]) continue;
    std::size_t met = (side + 3) % 4;  // the side before this corner, and before others of the same run
    while (inside[met]) met = (met + 3) % 4;
    next[sides[side]] = sides[met];
  }
}

std::vector<ContourPoint> without_straight_points(const std::vector<HalfPoint>& points) {
  std::vector<ContourPoint> kept;
  const std::size_t count = points.size();
  for (std::size_t n = 0; n < count; ++n) {
    const HalfPoint& before = points[(n + count - 1) % count];
    const HalfPoint& at = points[n];
    const HalfPoint& after = points[(n + 1) % count];
    const long long cross = static_cast<long long>(at.first - before.first) * (after.second - at.second) -
                            static_cast<long long>(at.second - before.second) * (after.first - at.first);
    if (cross != 0) kept.push_back({0.5 * at.second, 0.5 * at.first});
  }
  return kept;
}

}  // namespace

std::vector<std::vector<ContourPoint>> outlines_of(std::span<const std::uint8_t> slice, int columns, int rows,
                                                   std::uint8_t label) {
  int first_a = columns, last_a = -1, first_b = rows, last_b = -1;
  const auto has_label = [&](int a, int b) {
    return a >= 0 && b >= 0 && a < columns && b < rows &&
           slice[static_cast<std::size_t>(b) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(a)] ==
               label;
  };
  for (int b = 0; b < rows; ++b) {
    const auto row = slice.subspan(static_cast<std::size_t>(b) * static_cast<std::size_t>(columns),
                                   static_cast<std::size_t>(columns));
    const auto first = std::find(row.begin(), row.end(), label);
    if (first == row.end()) continue;
    const auto last = std::find(row.rbegin(), row.rend(), label);
    first_a = std::min(first_a, static_cast<int>(first - row.begin()));
    last_a = std::max(last_a, columns - 1 - static_cast<int>(last - row.rbegin()));
    first_b = std::min(first_b, b);
    last_b = b;
  }
  std::map<HalfPoint, HalfPoint> next;
  for (int b = first_b - 1; b <= last_b; ++b) {
    for (int a = first_a - 1; a <= last_a; ++a) {
      add_lines({has_label(a, b), has_label(a + 1, b), has_label(a + 1, b + 1), has_label(a, b + 1)}, a, b, next);
    }
  }
  std::vector<std::vector<ContourPoint>> outlines;
  while (!next.empty()) {
    std::vector<HalfPoint> points;
    for (auto at = next.begin(); at != next.end();) {
      points.push_back(at->first);
      const HalfPoint to = at->second;
      next.erase(at);
      at = next.find(to);
    }
    outlines.push_back(without_straight_points(points));
  }
  return outlines;
}

}  // namespace spinaltap::detail
