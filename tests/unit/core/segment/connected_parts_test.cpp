#include "core/segment/detail/connected_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

using Voxels = std::vector<std::uint8_t>;

GridGeometry geometry_of(int columns, int rows, int slices) {
  GridGeometry geometry;
  geometry.size = {columns, rows, slices};
  return geometry;
}

/// Of every voxel the least offset in its part, by union of neighbours; voxels outside have their own.
std::vector<std::size_t> roots_of(const Voxels& inside, const GridGeometry& geometry) {
  std::vector<std::size_t> root(inside.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t i) {
    while (root[i] != i) i = root[i];
    return i;
  };
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const std::size_t here = geometry.offset(i, j, k);
        for (const auto& step : {std::array<int, 3>{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
          if (!geometry.contains(i + step[0], j + step[1], k + step[2])) continue;
          const std::size_t there = geometry.offset(i + step[0], j + step[1], k + step[2]);
          if (inside[here] == 0 || inside[there] == 0) continue;
          const std::size_t a = find(here), b = find(there);
          root[std::max(a, b)] = std::min(a, b);
        }
      }
    }
  }
  for (std::size_t i = 0; i < root.size(); ++i) root[i] = find(i);
  return root;
}

class RandomVoxels : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(RandomVoxels, FormTheSamePartsAsByUnionOfNeighbours) {
  const std::uint64_t seed = GetParam();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  const auto length = [&](std::uint64_t n) { return 1 + static_cast<int>(20.0 * random_uniform(seed, n)); };
  const GridGeometry geometry = geometry_of(length(1), length(2), length(3));
  // Around the share (0.31) at which a part that spans the grid appears.
  const double share = 0.15 + 0.4 * random_uniform(seed, 4);
  Voxels inside;
  Voxels touched;
  for (std::size_t i = 0; i < geometry.voxel_count(); ++i) {
    inside.push_back(random_uniform(seed, 100 + 2 * i) < share ? 1 : 0);
    touched.push_back(random_uniform(seed, 101 + 2 * i) < 0.02 ? 1 : 0);
  }
  const std::vector<std::size_t> root = roots_of(inside, geometry);
  std::vector<bool> root_is_touched(inside.size(), false);
  std::vector<std::size_t> size(inside.size(), 0);
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (inside[i] == 0) continue;
    ++size[root[i]];
    if (touched[i] != 0) root_is_touched[root[i]] = true;
  }
  const Voxels parts = parts_that_touch(inside, touched, geometry);
  for (std::size_t i = 0; i < inside.size(); ++i) {
    ASSERT_EQ(parts[i] != 0, inside[i] != 0 && root_is_touched[root[i]]);
  }
  std::erase(size, std::size_t{0});
  std::sort(size.begin(), size.end(), std::greater<>());
  EXPECT_EQ(part_sizes(inside, geometry), size);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomVoxels, ::testing::Range<std::uint64_t>(1, 31));

TEST(ConnectedParts, JoinsThroughFacesOnly) {
  EXPECT_EQ(part_sizes(Voxels{1, 0, 0, 1}, geometry_of(2, 2, 1)), (std::vector<std::size_t>{1, 1}));
}

TEST(ConnectedParts, JoinThroughEdgesAndCornersWhereThatIsAsked) {
  const auto sizes = [](const Voxels& inside, const GridGeometry& geometry) {
    return part_sizes(inside, geometry, Neighbours::by_corner);
  };
  EXPECT_EQ(sizes(Voxels{1, 0, 0, 1}, geometry_of(2, 2, 1)), std::vector<std::size_t>{2});
  EXPECT_EQ(sizes(Voxels{0, 1, 1, 0}, geometry_of(2, 2, 1)), std::vector<std::size_t>{2});
  for (int corner = 0; corner < 4; ++corner) {  // the diagonals of a cube
    Voxels inside(8, 0);
    inside[static_cast<std::size_t>(corner)] = inside[static_cast<std::size_t>(7 - corner)] = 1;
    EXPECT_EQ(sizes(inside, geometry_of(2, 2, 2)), std::vector<std::size_t>{2}) << corner;
    EXPECT_EQ(part_sizes(inside, geometry_of(2, 2, 2)).size(), 2U);
  }
  EXPECT_EQ(sizes(Voxels{1, 0, 0, 0, 0, 1}, geometry_of(3, 2, 1)), (std::vector<std::size_t>{1, 1}));
  EXPECT_EQ(sizes(Voxels{1, 1, 0, 1, 0, 0, 1, 0}, geometry_of(4, 2, 1)), std::vector<std::size_t>{4});
}

TEST(ConnectedParts, GivesTheLargestAndOfEqualOnesTheFirst) {
  const GridGeometry geometry = geometry_of(8, 1, 1);
  EXPECT_EQ(largest_part(Voxels{1, 0, 1, 1, 0, 1, 1, 0}, geometry), (Voxels{0, 0, 1, 1, 0, 0, 0, 0}));
  EXPECT_EQ(largest_part(Voxels(8, 0), geometry), Voxels(8, 0));
}

TEST(ConnectedParts, RejectsMasksOfAnotherSize) {
  EXPECT_THROW(largest_part(Voxels(7, 1), geometry_of(2, 2, 2)), Error);
  EXPECT_THROW(parts_that_touch(Voxels(8, 1), Voxels(7, 1), geometry_of(2, 2, 2)), Error);
  EXPECT_THROW(part_sizes(Voxels(7, 1), geometry_of(2, 2, 2)), Error);
}

/// A cube of 15 voxels with a hollow of 7 in it, in a grid of 21, and a square shaft from above, `width` voxels wide.
Voxels hollow_cube(int width) {
  const GridGeometry geometry = geometry_of(21, 21, 21);
  Voxels cube(geometry.voxel_count(), 0);
  const auto within = [](int low, int high, int i, int j, int k) {
    return std::min({i, j, k}) >= low && std::max({i, j, k}) <= high;
  };
  for (int k = 0; k < 21; ++k) {
    for (int j = 0; j < 21; ++j) {
      for (int i = 0; i < 21; ++i) {
        const bool in_shaft = k > 10 && std::abs(2 * (i - 10)) < width && std::abs(2 * (j - 10)) < width;
        cube[geometry.offset(i, j, k)] = within(3, 17, i, j, k) && !within(7, 13, i, j, k) && !in_shaft;
      }
    }
  }
  return cube;
}

TEST(FillHollows, FillsAClosedHollowAndNothingElse) {
  const GridGeometry geometry = geometry_of(21, 21, 21);
  const Voxels filled = fill_hollows(hollow_cube(0), geometry, 0.0);
  EXPECT_EQ(std::count(filled.begin(), filled.end(), 1), 15 * 15 * 15);
}

TEST(FillHollows, SealsAShaftNarrowerThanTheBall) {
  const GridGeometry geometry = geometry_of(21, 21, 21);
  EXPECT_EQ(fill_hollows(hollow_cube(3), geometry, 0.0), hollow_cube(3));  // open without a ball
  EXPECT_EQ(fill_hollows(hollow_cube(3), geometry, 2.5)[geometry.offset(10, 10, 10)], 1);
  EXPECT_EQ(fill_hollows(hollow_cube(7), geometry, 2.5)[geometry.offset(10, 10, 10)], 0);
}

TEST(FillHollows, RejectsAnAbsurdBall) {
  const GridGeometry geometry = geometry_of(2, 2, 2);
  EXPECT_THROW(fill_hollows(Voxels(8, 1), geometry, -1.0), Error);
  EXPECT_THROW(fill_hollows(Voxels(8, 1), geometry, std::nan("")), Error);
}

}  // namespace
}  // namespace spinaltap
