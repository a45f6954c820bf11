#include "core/segment/random_walker.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

using WalkerVoxels = std::vector<WalkerVoxel>;
constexpr WalkerVoxel kOutside = WalkerVoxel::kOutside;
constexpr WalkerVoxel kFree = WalkerVoxel::kFree;
constexpr WalkerVoxel kWanted = WalkerVoxel::kWanted;
constexpr WalkerVoxel kOther = WalkerVoxel::kOther;

GridGeometry line_of(int voxels) {
  GridGeometry geometry;
  geometry.size = {voxels, 1, 1};
  return geometry;
}

TEST(RandomWalker, FallsEvenlyAlongAnEvenLine) {
  WalkerVoxels line(11, kFree);
  line.front() = kWanted;
  line.back() = kOther;
  const std::vector<float> p = walk_randomly(line, std::vector<float>(11, 0.3F), line_of(11));
  // The gambler's ruin: the probability falls by a tenth each step.
  for (std::size_t i = 0; i < 11; ++i) EXPECT_NEAR(p[i], 1.0 - 0.1 * static_cast<double>(i), 1e-4);
}

TEST(RandomWalker, FallsOverABarrierAsOverResistorsInARow) {
  // Steps resist by 1 over the smaller conductivity: 1, 1, 10, 10, 1, 1 of 24 in all.
  const WalkerVoxels line{kWanted, kFree, kFree, kFree, kFree, kFree, kOther};
  const std::vector<float> p = walk_randomly(line, std::vector<float>{1, 1, 1, 0.1F, 1, 1, 1}, line_of(7));
  EXPECT_NEAR(p[2], 22.0 / 24.0, 1e-4);
  EXPECT_NEAR(p[3], 12.0 / 24.0, 1e-4);
  EXPECT_NEAR(p[4], 2.0 / 24.0, 1e-4);
}

TEST(RandomWalker, WeighsFacesByAreaOverDistance) {
  // From the middle: two steps of 1 mm over faces of 2 mm², two of 2 mm over 1 mm²: four times as likely.
  GridGeometry geometry;
  geometry.size = {3, 3, 1};
  geometry.spacing_mm = Vec3(1.0, 2.0, 1.0);
  const WalkerVoxels cross{kOutside, kOther, kOutside, kWanted, kFree, kWanted, kOutside, kOther, kOutside};
  EXPECT_NEAR(walk_randomly(cross, std::vector<float>(9, 1.0F), geometry)[4], 0.8, 1e-4);
}

TEST(RandomWalker, GivesNothingWhereNoMarkerCanBeReached) {
  const WalkerVoxels line{kWanted, kFree, kOutside, kFree, kFree};
  const std::vector<float> p = walk_randomly(line, std::vector<float>(5, 1.0F), line_of(5));
  EXPECT_NEAR(p[1], 1.0, 1e-4);
  EXPECT_EQ(p[2], 0.0F);
  EXPECT_EQ(p[3], 0.0F);
}

/// Each free voxel's probability is the mean of its neighbours', weighted by how they conduct: by definition, whatever
/// the solver, in a world of rooms with walls that conduct a thousandth.
TEST(RandomWalker, IsTheWeightedMeanOfItsNeighboursBehindManyWalls) {
  GridGeometry geometry;
  geometry.size = {24, 22, 20};
  geometry.spacing_mm = Vec3(0.8, 0.8, 1.1);
  const std::size_t count = geometry.voxel_count();
  WalkerVoxels voxels(count, kFree);
  std::vector<float> conductivity(count);
  std::size_t v = 0;
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i, ++v) {
        const bool is_wall = i % 6 == 5 || j % 7 == 6 || k % 5 == 4;
        conductivity[v] = is_wall ? 1e-3F : static_cast<float>(0.3 + 0.7 * random_uniform(5, v));
        if (random_uniform(6, v) < 0.05) voxels[v] = kOutside;
        if (i == 0) voxels[v] = kWanted;
        if (i == geometry.size[0] - 1) voxels[v] = kOther;
      }
    }
  }
  const std::vector<float> p = walk_randomly(voxels, conductivity, geometry);
  const Vec3 step = geometry.spacing_mm;
  const std::array<std::size_t, 3> stride{1, geometry.offset(0, 1, 0), geometry.offset(0, 0, 1)};
  double worst = 0.0, least = 1.0, most = 0.0;
  v = 0;
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i, ++v) {
        if (voxels[v] != kFree) continue;
        const std::array<int, 3> index{i, j, k};
        double sum = 0.0, weights = 0.0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const auto a = static_cast<Eigen::Index>(axis);
          for (const int side : {-1, 1}) {
            const int at = index[axis] + side;
            if (at < 0 || at >= geometry.size[axis]) continue;
            const std::size_t next = side < 0 ? v - stride[axis] : v + stride[axis];
            if (voxels[next] == kOutside) continue;
            const double weight = std::min(conductivity[v], conductivity[next]) * step.prod() / (step[a] * step[a]);
            sum += weight * static_cast<double>(p[next]);
            weights += weight;
          }
        }
        if (weights == 0.0) continue;
        worst = std::max(worst, std::abs(sum / weights - static_cast<double>(p[v])));
        least = std::min(least, static_cast<double>(p[v]));
        most = std::max(most, static_cast<double>(p[v]));
      }
    }
  }
  EXPECT_LT(worst, 1e-4);
  EXPECT_GT(most, 0.9);
  EXPECT_LT(least, 0.1);
}

TEST(RandomWalker, KeepsMarkersThatLeaveNothingFree) {
  EXPECT_EQ(walk_randomly(WalkerVoxels{kWanted, kOther}, std::vector<float>(2, 1.0F), line_of(2)),
            (std::vector<float>{1.0F, 0.0F}));
}

TEST(RandomWalker, RejectsListsOfAnotherSize) {
  EXPECT_THROW(walk_randomly(WalkerVoxels(3, kFree), std::vector<float>(3, 1.0F), line_of(4)), Error);
  EXPECT_THROW(walk_randomly(WalkerVoxels(4, kFree), std::vector<float>(3, 1.0F), line_of(4)), Error);
}

}  // namespace
}  // namespace spinaltap
