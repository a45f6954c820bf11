#include "core/segment/connected_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

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
std::vector<std::size_t> parts(const Voxels& inside, const GridGeometry& geometry) {
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

class RandomVoxels : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  RandomVoxels() {
    const std::uint64_t seed = GetParam();
    const auto length = [&](std::uint64_t n) { return 1 + static_cast<int>(12.0 * random_uniform(seed, n)); };
    geometry_ = geometry_of(length(1), length(2), length(3));
    // Around the share (0.31) at which a part that spans the grid appears.
    const double share = 0.15 + 0.4 * random_uniform(seed, 4);
    for (std::size_t i = 0; i < geometry_.voxel_count(); ++i) {
      inside_.push_back(random_uniform(seed, 100 + i) < share ? 1 : 0);
    }
    root_ = parts(inside_, geometry_);
  }

  GridGeometry geometry_;
  Voxels inside_;
  std::vector<std::size_t> root_;
};

TEST_P(RandomVoxels, FormTheSamePartAsByUnionOfNeighbours) {
  SCOPED_TRACE(::testing::Message() << "seed " << GetParam());
  for (std::size_t seed = 0; seed < inside_.size(); seed += 1 + inside_.size() / 50) {
    const Voxels part = connected_part(inside_, geometry_, seed);
    for (std::size_t i = 0; i < inside_.size(); ++i) {
      ASSERT_EQ(part[i] != 0, inside_[seed] != 0 && inside_[i] != 0 && root_[i] == root_[seed]);
    }
  }
}

TEST_P(RandomVoxels, HaveTheLargestPartThatCountingFinds) {
  SCOPED_TRACE(::testing::Message() << "seed " << GetParam());
  std::vector<std::size_t> count(inside_.size(), 0);
  for (std::size_t i = 0; i < inside_.size(); ++i) count[root_[i]] += inside_[i];
  // Roots are the least offsets, so the first of equal counts is the first in memory.
  const auto best = static_cast<std::size_t>(std::max_element(count.begin(), count.end()) - count.begin());
  const Voxels part = largest_part(inside_, geometry_);
  for (std::size_t i = 0; i < inside_.size(); ++i) ASSERT_EQ(part[i] != 0, inside_[i] != 0 && root_[i] == best);
}

TEST_P(RandomVoxels, ReachTheBorderWhereTheirPartDoes) {
  SCOPED_TRACE(::testing::Message() << "seed " << GetParam());
  std::vector<bool> reaches(inside_.size(), false);
  for (int k = 0; k < geometry_.size[2]; ++k) {
    for (int j = 0; j < geometry_.size[1]; ++j) {
      for (int i = 0; i < geometry_.size[0]; ++i) {
        const bool border = i == 0 || j == 0 || k == 0 || i == geometry_.size[0] - 1 || j == geometry_.size[1] - 1 ||
                            k == geometry_.size[2] - 1;
        if (border) reaches[root_[geometry_.offset(i, j, k)]] = true;
      }
    }
  }
  const Voxels part = connected_to_border(inside_, geometry_);
  for (std::size_t i = 0; i < inside_.size(); ++i) ASSERT_EQ(part[i] != 0, inside_[i] != 0 && reaches[root_[i]]);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomVoxels, ::testing::Range<std::uint64_t>(1, 41));

TEST(ConnectedParts, JoinsThroughFacesOnly) {
  const GridGeometry geometry = geometry_of(2, 2, 1);
  const Voxels diagonal{1, 0, 0, 1};
  EXPECT_EQ(connected_part(diagonal, geometry, 0), (Voxels{1, 0, 0, 0}));
  EXPECT_EQ(largest_part(diagonal, geometry), (Voxels{1, 0, 0, 0}));
}

TEST(ConnectedParts, DoesNotJoinTheEndOfARowWithTheNextRow) {
  const GridGeometry geometry = geometry_of(3, 2, 1);
  const Voxels inside{0, 0, 1, 1, 0, 0};
  EXPECT_EQ(connected_part(inside, geometry, 2), (Voxels{0, 0, 1, 0, 0, 0}));
}

TEST(ConnectedParts, FindsNothingInNothing) {
  const GridGeometry geometry = geometry_of(3, 3, 3);
  const Voxels none(27, 0);
  EXPECT_EQ(largest_part(none, geometry), none);
  EXPECT_EQ(connected_to_border(none, geometry), none);
  EXPECT_EQ(connected_part(none, geometry, 13), none);
  EXPECT_EQ(connected_part(Voxels(27, 1), geometry, 27), none);  // a seed beyond the grid
}

}  // namespace
}  // namespace spinaltap
