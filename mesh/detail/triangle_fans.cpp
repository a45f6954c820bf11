#include "mesh/detail/triangle_fans.h"

#include <algorithm>

namespace spinaltap::detail {

TriangleFans::TriangleFans(std::size_t vertices, std::span<const Triangle> triangles) : ranges_(vertices) {
  for (const Triangle& t : triangles) {
    for (const std::uint32_t corner : t) ++ranges_[corner].room;
  }
  std::uint32_t begin = 0;
  for (Range& range : ranges_) {
    range.begin = begin;
    begin += range.room;
  }
  listed_.resize(begin);
  for (std::uint32_t n = 0; n < triangles.size(); ++n) {
    for (const std::uint32_t corner : triangles[n]) {
      Range& range = ranges_[corner];
      listed_[range.begin + range.count++] = n;
    }
  }
}

void TriangleFans::remove(std::uint32_t vertex, std::uint32_t triangle) {
  Range& range = ranges_[vertex];
  const auto begin = listed_.begin() + range.begin;
  const auto end = begin + range.count;
  const auto found = std::find(begin, end, triangle);
  if (found == end) return;
  std::copy(found + 1, end, found);
  --range.count;
}

void TriangleFans::add(std::uint32_t vertex, std::span<const std::uint32_t> triangles) {
  Range& range = ranges_[vertex];
  const auto count = range.count + static_cast<std::uint32_t>(triangles.size());
  if (count > range.room) {
    const auto begin = static_cast<std::uint32_t>(listed_.size());
    const std::uint32_t room = count + count / 2;
    listed_.resize(listed_.size() + room);
    std::copy_n(listed_.begin() + range.begin, range.count, listed_.begin() + begin);
    range.begin = begin;
    range.room = room;
  }
  std::copy(triangles.begin(), triangles.end(), listed_.begin() + range.begin + range.count);
  range.count = count;
}

}  // namespace spinaltap::detail
