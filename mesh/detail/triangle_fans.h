#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace spinaltap::detail {

/// The triangles around each vertex, while edges are collapsed.
class TriangleFans {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  TriangleFans(std::size_t vertices, std::span<const Triangle> triangles);

  /// In no order that means anything, but in one that depends on the triangles and on what was done alone.
  std::span<const std::uint32_t> of(std::uint32_t vertex) const {
    return std::span(listed_).subspan(ranges_[vertex].begin, ranges_[vertex].count);
  }
  void remove(std::uint32_t vertex, std::uint32_t triangle);
  void add(std::uint32_t vertex, std::span<const std::uint32_t> triangles);
  void clear(std::uint32_t vertex) { ranges_[vertex].count = 0; }

 private:
  struct Range {
    std::uint32_t begin = 0;
    std::uint32_t count = 0;
    std::uint32_t room = 0;
  };
  std::vector<Range> ranges_;
  std::vector<std::uint32_t> listed_;
};

}  // namespace spinaltap::detail
