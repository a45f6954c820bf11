// Marching squares (Lorensen & Cline's cubes in the plane) on a mask: each crossing lies half-way, and channels to
// holes a quarter of a pixel beside it, so that points are kept as whole numbers of quarter pixels and lines meet
// exactly.

#include "core/ct/detail/mask_contours.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iterator>
#include <list>
#include <map>
#include <utility>

namespace spinaltap::detail {
namespace {

using QuarterPoint = std::pair<int, int>;  // b first, then a: the order in which outlines begin
using Loop = std::list<QuarterPoint>;      // places in it stay when others are put into it

/// The lines of the cell whose first corner is pixel (a, b): from where the bone is left to where it was met, walking
/// around the cell. Its neighbour walks the shared side the other way, so that lines join.
void add_lines(const std::array<bool, 4>& inside, int a, int b, std::map<QuarterPoint, QuarterPoint>& next) {
  const std::array<QuarterPoint, 4> sides{QuarterPoint{4 * b, 4 * a + 2}, QuarterPoint{4 * b + 2, 4 * a + 4},
                                          QuarterPoint{4 * b + 4, 4 * a + 2}, QuarterPoint{4 * b + 2, 4 * a}};
  for (std::size_t side = 0; side < 4; ++side) {
    if (!inside[side] || inside[(side + 1) % 4]) continue;
    std::size_t met = (side + 3) % 4;  // the side before this corner, and before others of the same run
    while (inside[met]) met = (met + 3) % 4;
    next[sides[side]] = sides[met];
  }
}

/// The point a quarter of a pixel along a from `at`, on the line to `to`.
QuarterPoint channel_point(const QuarterPoint& at, const QuarterPoint& to) {
  const int across = std::abs(to.second - at.second);
  return {at.first + (to.first - at.first) / across, at.second + (to.second - at.second) / across};
}

/// Makes a hole, which begins at its uppermost point, a part of `loop`, which has the point `above` over that one.
/// Bone lies to the right of lines: they run to smaller a along a hole's upper side and to larger a along a loop's, so
/// that the channel, at a larger a than both points, comes before the one and after the other.
void join_hole(Loop& hole, const Loop::iterator& above, Loop& loop) {
  const auto after = std::next(above);  // there is one: loops begin at their uppermost point and end beside it, lower
  const QuarterPoint outer = channel_point(*above, *after);
  const QuarterPoint inner = channel_point(hole.front(), hole.back());
  hole.insert(hole.begin(), {outer, inner});
  hole.insert(hole.end(), {inner, outer});
  loop.splice(after, hole);
}

std::vector<ContourPoint> without_straight_points(const Loop& points) {
  std::vector<ContourPoint> kept;
  for (auto at = points.begin(); at != points.end(); ++at) {
    const QuarterPoint& before = at == points.begin() ? points.back() : *std::prev(at);
    const QuarterPoint& after = std::next(at) == points.end() ? points.front() : *std::next(at);
    const long long cross = static_cast<long long>(at->first - before.first) * (after.second - at->second) -
                            static_cast<long long>(at->second - before.second) * (after.first - at->first);
    if (cross != 0) kept.push_back({0.25 * at->second, 0.25 * at->first});
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
  std::map<QuarterPoint, QuarterPoint> next;
  for (int b = first_b - 1; b <= last_b; ++b) {
    for (int a = first_a - 1; a <= last_a; ++a) {
      add_lines({has_label(a, b), has_label(a + 1, b), has_label(a + 1, b + 1), has_label(a, b + 1)}, a, b, next);
    }
  }
  std::vector<Loop> loops;
  std::vector<std::size_t> part_of;  // each loop, or the one that a hole was joined to
  std::map<QuarterPoint, std::pair<std::size_t, Loop::iterator>> places;
  while (!next.empty()) {
    const std::size_t number = loops.size();
    Loop& loop = loops.emplace_back();
    for (auto at = next.begin(); at != next.end();) {
      loop.push_back(at->first);
      places[at->first] = {number, std::prev(loop.end())};
      const QuarterPoint to = at->second;
      next.erase(at);
      at = next.find(to);
    }
    part_of.push_back(number);
    const auto [top_b, top_a] = loop.front();
    const bool is_hole = has_label(top_a / 4, (top_b - 2) / 4);
    if (!is_hole) continue;
    // Loops begin at their uppermost points and come in the order of these, so that the one above is there. No two
    // holes find the same point of it: the lower one's way up ends at the upper one.
    auto above = places.end();
    for (int b = top_b - 4; above == places.end(); b -= 4) above = places.find({b, top_a});
    const auto& [other, point] = above->second;
    part_of[number] = part_of[other];
    join_hole(loop, point, loops[part_of[number]]);
  }
  std::vector<std::vector<ContourPoint>> outlines;
  for (const Loop& loop : loops) {
    if (!loop.empty()) outlines.push_back(without_straight_points(loop));
  }
  return outlines;
}

}  // namespace spinaltap::detail
