#include "core/segment/random_walker.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

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
