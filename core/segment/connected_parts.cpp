#include "core/segment/connected_parts.h"

#include <array>

namespace spinaltap {
namespace {

/// Marks with `mark` in `marks` every voxel reached from the open list through faces; returns how many.
std::size_t flood(std::span<const std::uint8_t> inside, const GridGeometry& geometry, std::uint8_t mark,
                  std::vector<std::uint8_t>& marks, std::vector<std::size_t>& open) {
  const std::array<std::size_t, 3> stride{1, geometry.offset(0, 1, 0), geometry.offset(0, 0, 1)};
  std::size_t reached = open.size();
  while (!open.empty()) {
    const std::size_t voxel = open.back();
    open.pop_back();
    std::size_t rest = voxel;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto length = static_cast<std::size_t>(geometry.size[axis]);
      const std::size_t coordinate = rest % length;
      rest /= length;
      const auto visit = [&](std::size_t neighbour) {
        if (inside[neighbour] == 0 || marks[neighbour] != 0) return;
        marks[neighbour] = mark;
        open.push_back(neighbour);
        ++reached;
      };
      if (coordinate > 0) visit(voxel - stride[axis]);
      if (coordinate + 1 < length) visit(voxel + stride[axis]);
    }
  }
  return reached;
}

}  // namespace

std::vector<std::uint8_t> connected_part(std::span<const std::uint8_t> inside, const GridGeometry& geometry,
                                         std::size_t seed) {
  std::vector<std::uint8_t> marks(inside.size(), 0);
  if (seed < inside.size() && inside[seed] != 0) {
    std::vector<std::size_t> open{seed};
    marks[seed] = 1;
    flood(inside, geometry, 1, marks, open);
  }
  return marks;
}

std::vector<std::uint8_t> largest_part(std::span<const std::uint8_t> inside, const GridGeometry& geometry) {
  std::vector<std::uint8_t> marks(inside.size(), 0);
  std::vector<std::size_t> open;
  std::size_t best_seed = inside.size();
  std::size_t best_count = 0;
  for (std::size_t voxel = 0; voxel < inside.size(); ++voxel) {
    if (inside[voxel] == 0 || marks[voxel] != 0) continue;
    marks[voxel] = 1;
    open.assign(1, voxel);
    const std::size_t count = flood(inside, geometry, 1, marks, open);
    if (count > best_count) {
      best_count = count;
      best_seed = voxel;
    }
  }
  return connected_part(inside, geometry, best_seed);
}

std::vector<std::uint8_t> connected_to_border(std::span<const std::uint8_t> inside, const GridGeometry& geometry) {
  std::vector<std::uint8_t> marks(inside.size(), 0);
  std::vector<std::size_t> open;
  const auto& size = geometry.size;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      const bool whole_row = k == 0 || j == 0 || k == size[2] - 1 || j == size[1] - 1;
      for (int i = 0; i < size[0]; i += whole_row || size[0] < 2 ? 1 : size[0] - 1) {
        const std::size_t voxel = geometry.offset(i, j, k);
        if (inside[voxel] == 0 || marks[voxel] != 0) continue;
        marks[voxel] = 1;
        open.push_back(voxel);
      }
    }
  }
  flood(inside, geometry, 1, marks, open);
  return marks;
}

}  // namespace spinaltap
