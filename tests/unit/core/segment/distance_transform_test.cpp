#include "core/segment/distance_transform.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

class RandomTarget : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(RandomTarget, IsAsFarAsTheNearestOfAllItsVoxels) {
  const std::uint64_t seed = GetParam();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  GridGeometry geometry;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    geometry.size[axis] = 1 + static_cast<int>(14.0 * random_uniform(seed, axis));
    geometry.spacing_mm[static_cast<Eigen::Index>(axis)] = 0.2 + 2.0 * random_uniform(seed, 10 + axis);
  }
  geometry.directions = Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const double share = seed % 2 == 0 ? 0.01 : 0.3;
  std::vector<std::uint8_t> target;
  std::vector<Vec3> target_mm;
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        target.push_back(random_uniform(seed, 100 + target.size()) < share ? 1 : 0);
        if (target.back() != 0) target_mm.push_back(geometry.to_patient(Vec3(i, j, k)));
      }
    }
  }
  const std::vector<float> distance = squared_distance_to(target, geometry);
  const double reach_mm = seed % 5 == 0 ? 0.0 : 6.0 * random_uniform(seed, 20);
  const std::vector<float> within = squared_distance_within(target, geometry, reach_mm);
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const Vec3 p_mm = geometry.to_patient(Vec3(i, j, k));
        double expected = std::numeric_limits<double>::infinity();
        for (const Vec3& t : target_mm) expected = std::min(expected, (t - p_mm).squaredNorm());
        const float found = distance[geometry.offset(i, j, k)];
        if (target_mm.empty()) {
          ASSERT_EQ(found, std::numeric_limits<float>::infinity());
        } else {
          // Each of three passes rounds to float: 3 times 6e-8 of the value.
          ASSERT_NEAR(found, expected, 2e-7 * expected + 1e-12);
        }
        const float near = within[geometry.offset(i, j, k)];
        if (near < std::numeric_limits<float>::infinity()) {
          ASSERT_NEAR(near, expected, 2e-7 * expected + 1e-12);
        } else {
          ASSERT_GT(expected, (1.0 - 1e-6) * reach_mm * reach_mm);
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomTarget, ::testing::Range<std::uint64_t>(1, 41));

TEST(SquaredDistance, IsInfiniteWithoutATarget) {
  GridGeometry geometry;
  geometry.size = {4, 3, 5};
  for (const float value : squared_distance_to(std::vector<std::uint8_t>(60, 0), geometry)) {
    EXPECT_EQ(value, std::numeric_limits<float>::infinity());
  }
}

TEST(SquaredDistance, WithinAReachIsThatOfTheWholeAndNothingBeyond) {
  GridGeometry geometry;
  geometry.size = {40, 30, 20};
  geometry.spacing_mm = Vec3(0.4, 0.7, 1.5);
  std::vector<std::uint8_t> target(geometry.voxel_count(), 0);
  for (std::size_t i = 0; i < target.size(); ++i) target[i] = random_uniform(8, i) < 0.002 ? 1 : 0;
  const std::vector<float> whole = squared_distance_to(target, geometry);
  const std::vector<float> within = squared_distance_within(target, geometry, 4.0);
  std::size_t near = 0;
  for (std::size_t v = 0; v < whole.size(); ++v) {
    if (whole[v] < 15.999F) {
      ASSERT_NEAR(within[v], whole[v], 1e-5F);
      ++near;
    } else if (whole[v] > 16.001F) {
      ASSERT_EQ(within[v], std::numeric_limits<float>::infinity());
    }
  }
  EXPECT_GT(near, 1000U);
  EXPECT_LT(near, whole.size());
  EXPECT_EQ(squared_distance_within(target, geometry, std::numeric_limits<double>::infinity()).size(), target.size());
  EXPECT_THROW(squared_distance_within(target, geometry, -1.0), Error);
  EXPECT_THROW(squared_distance_within(target, geometry, std::numeric_limits<double>::quiet_NaN()), Error);
}

// Three times 0.1 is a little over 0.3 in doubles.
TEST(SquaredDistance, WithinAReachHoldsWhatLiesJustAtIt) {
  GridGeometry geometry;
  geometry.size = {5, 1, 1};
  geometry.spacing_mm = Vec3(0.1, 1.0, 1.0);
  const std::vector<float> within = squared_distance_within(std::vector<std::uint8_t>{1, 0, 0, 0, 0}, geometry, 0.3);
  EXPECT_NEAR(within[3], 0.09F, 1e-7F);
  EXPECT_EQ(within[4], std::numeric_limits<float>::infinity());
}

TEST(SquaredDistance, IsZeroOnTheTargetAndCountsStepsFromACorner) {
  GridGeometry geometry;
  geometry.size = {5, 5, 5};
  geometry.spacing_mm = Vec3(1.0, 2.0, 3.0);
  std::vector<std::uint8_t> target(125, 0);
  target[0] = 1;
  const std::vector<float> distance = squared_distance_to(target, geometry);
  EXPECT_EQ(distance[0], 0.0F);
  EXPECT_EQ(distance[geometry.offset(4, 0, 0)], 16.0F);
  EXPECT_EQ(distance[geometry.offset(1, 2, 3)], 1.0F + 16.0F + 81.0F);
}

TEST(SquaredDistance, GivesTheSameBitsAtAnyNumberOfThreads) {
  GridGeometry geometry;
  geometry.size = {30, 31, 29};
  geometry.spacing_mm = Vec3(0.352, 0.352, 0.5);
  std::vector<std::uint8_t> target(geometry.voxel_count());
  for (std::size_t i = 0; i < target.size(); ++i) target[i] = random_uniform(3, i) < 0.02 ? 1 : 0;
  std::vector<float> one, one_within;
  {
    const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
    one = squared_distance_to(target, geometry);
    one_within = squared_distance_within(target, geometry, 1.5);
  }
  const tbb::global_control parallel(tbb::global_control::max_allowed_parallelism, 2);
  EXPECT_EQ(squared_distance_to(target, geometry), one);
  EXPECT_EQ(squared_distance_within(target, geometry, 1.5), one_within);
}

}  // namespace
}  // namespace spinaltap
