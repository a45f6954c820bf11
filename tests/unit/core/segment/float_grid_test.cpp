#include "core/segment/float_grid.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

FloatGrid grid_of(const std::array<int, 3>& size, const Vec3& spacing_mm, float value = 0.0F) {
  FloatGrid grid;
  grid.geometry.size = size;
  grid.geometry.spacing_mm = spacing_mm;
  grid.values.assign(grid.geometry.voxel_count(), value);
  return grid;
}

/// A grid at an angle, away from the origin.
GridGeometry askew_grid() {
  GridGeometry geometry;
  geometry.size = {7, 6, 5};
  geometry.origin_mm = Vec3(10.0, -20.0, 30.0);
  geometry.spacing_mm = Vec3(0.5, 0.7, 1.25);
  geometry.directions = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  return geometry;
}

CtVolume counting_ct() {
  std::vector<std::int16_t> hu(7 * 6 * 5);
  std::iota(hu.begin(), hu.end(), std::int16_t{0});
  return make_ct_volume(askew_grid(), std::move(hu));
}

TEST(GaussianBlur, KeepsAConstant) {
  const FloatGrid blurred = gaussian_blur(grid_of({9, 5, 12}, Vec3(0.4, 0.7, 1.25), 321.0F), 1.3);
  // The kernel's 3 x 9 float weights sum to 1 within their rounding.
  for (const float value : blurred.values) ASSERT_NEAR(value, 321.0, 321.0 * 1e-6);
}

TEST(GaussianBlur, KeepsTheSumAwayFromTheBorder) {
  FloatGrid grid = grid_of({41, 41, 41}, Vec3(0.5, 0.5, 0.5));
  constexpr std::uint64_t kSeed = 5;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  for (int k = 15; k < 26; ++k) {
    for (int j = 15; j < 26; ++j) {
      for (int i = 15; i < 26; ++i) {
        const std::size_t at = grid.geometry.offset(i, j, k);
        grid.values[at] = static_cast<float>(random_uniform(kSeed, at));
      }
    }
  }
  const FloatGrid blurred = gaussian_blur(grid, 2.0);  // reaches 12 voxels
  const double before = std::accumulate(grid.values.begin(), grid.values.end(), 0.0);
  const double after = std::accumulate(blurred.values.begin(), blurred.values.end(), 0.0);
  EXPECT_NEAR(after, before, 1e-5 * before);
}

TEST(GaussianBlur, SpreadsAnImpulseAsTheAnalyticGaussian) {
  const Vec3 spacing_mm(0.5, 0.4, 0.8);
  const double sigma_mm = 1.0;
  FloatGrid grid = grid_of({21, 25, 15}, spacing_mm);
  const std::array<int, 3> middle{10, 12, 7};
  grid.values[grid.geometry.offset(10, 12, 7)] = 1.0F;
  const FloatGrid blurred = gaussian_blur(grid, sigma_mm);
  for (int k = 0; k < 15; ++k) {
    for (int j = 0; j < 25; ++j) {
      for (int i = 0; i < 21; ++i) {
        const Vec3 from_mm = Vec3(i - middle[0], j - middle[1], k - middle[2]).cwiseProduct(spacing_mm);
        const double expected = spacing_mm.prod() / std::pow(2.0 * std::numbers::pi * sigma_mm * sigma_mm, 1.5) *
                                std::exp(-0.5 * from_mm.squaredNorm() / (sigma_mm * sigma_mm));
        // The kernel ends at 3 deviations and is scaled up by the 0.27% that it lacks, per axis; the peak is 0.01.
        ASSERT_NEAR(blurred.at(i, j, k), expected, 1e-4);
      }
    }
  }
}

TEST(GaussianBlur, GivesTheSameBitsAtAnyNumberOfThreads) {
  FloatGrid grid = grid_of({33, 29, 31}, Vec3(0.4, 0.5, 0.6));
  for (std::size_t i = 0; i < grid.values.size(); ++i) grid.values[i] = static_cast<float>(random_normal(7, i));
  FloatGrid one;
  {
    const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
    one = gaussian_blur(grid, 0.8);
  }
  const tbb::global_control parallel(tbb::global_control::max_allowed_parallelism, 2);
  EXPECT_EQ(gaussian_blur(grid, 0.8).values, one.values);
}

TEST(GaussianBlur, RejectsAWidthThatIsNone) {
  const FloatGrid grid = grid_of({5, 5, 5}, Vec3::Ones(), 1.0F);
  for (const double bad :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e9}) {
    EXPECT_THROW(gaussian_blur(grid, bad), Error) << bad;
  }
  // A width that is small against the voxels changes nothing.
  EXPECT_EQ(gaussian_blur(grid, 1e-3).values, grid.values);
  EXPECT_EQ(gaussian_blur(grid, 1e-200).values, grid.values);
}

TEST(MaskBox, HoldsTheMasksVoxelsAndNoMore) {
  BoneMask mask;
  mask.geometry = askew_grid();
  mask.inside.assign(mask.geometry.voxel_count(), 0);
  EXPECT_TRUE(mask_box(mask).empty());
  mask.inside[mask.geometry.offset(2, 1, 4)] = 1;
  mask.inside[mask.geometry.offset(5, 0, 3)] = 1;
  const VoxelBox box = mask_box(mask);
  EXPECT_EQ(box.low, (std::array<int, 3>{2, 0, 3}));
  EXPECT_EQ(box.high, (std::array<int, 3>{5, 1, 4}));
  // 1 mm is 2 voxels of 0.5 mm, 2 of 0.7 mm and 1 of 1.25 mm.
  const VoxelBox grown = grow_box(box, 1.0, mask.geometry);
  EXPECT_EQ(grown.low, (std::array<int, 3>{0, -2, 2}));
  EXPECT_EQ(grown.high, (std::array<int, 3>{7, 3, 5}));
}

TEST(Crop, KeepsEveryVoxelWhereItWas) {
  const CtVolume ct = counting_ct();
  const FloatGrid part = crop_hu(ct, {{1, 2, 3}, {4, 4, 4}});
  EXPECT_EQ(part.geometry.size, (std::array<int, 3>{4, 3, 2}));
  for (int k = 0; k < 2; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(part.at(i, j, k), ct.at(i + 1, j + 2, k + 3));
        EXPECT_LT((part.geometry.to_patient(Vec3(i, j, k)) - ct.geometry.to_patient(Vec3(i + 1, j + 2, k + 3))).norm(),
                  1e-12);
      }
    }
  }
}

TEST(Crop, RepeatsTheCtsBorderBeyondItAndEndsTheMaskThere) {
  const CtVolume ct = counting_ct();
  BoneMask mask{ct.geometry, std::vector<std::uint8_t>(ct.geometry.voxel_count(), 1)};
  const VoxelBox box{{-2, -1, -3}, {8, 7, 6}};
  const FloatGrid hu = crop_hu(ct, box);
  const FloatGrid inside = crop_mask(mask, box);
  for (int k = 0; k < 10; ++k) {
    for (int j = 0; j < 9; ++j) {
      for (int i = 0; i < 11; ++i) {
        const std::array<int, 3> at{i - 2, j - 1, k - 3};
        EXPECT_EQ(hu.at(i, j, k), ct.at(std::clamp(at[0], 0, 6), std::clamp(at[1], 0, 5), std::clamp(at[2], 0, 4)));
        EXPECT_EQ(inside.at(i, j, k), ct.geometry.contains(at[0], at[1], at[2]) ? 1.0F : 0.0F);
      }
    }
  }
  EXPECT_LT((hu.geometry.to_patient(Vec3(2, 1, 3)) - ct.geometry.origin_mm).norm(), 1e-12);
  EXPECT_THROW(crop_hu(ct, {{3, 0, 0}, {2, 1, 1}}), Error);
}

TEST(SampleClamped, IsExactForLinearGridsAndHoldsTheBorderBeyond) {
  FloatGrid grid = grid_of({4, 5, 6}, Vec3::Ones());
  for (int k = 0; k < 6; ++k) {
    for (int j = 0; j < 5; ++j) {
      for (int i = 0; i < 4; ++i) {
        grid.values[grid.geometry.offset(i, j, k)] = static_cast<float>(1 + 2 * i - 3 * j + 5 * k);
      }
    }
  }
  EXPECT_NEAR(sample_clamped(grid, Vec3(1.25, 2.5, 3.75)), 1 + 2 * 1.25 - 3 * 2.5 + 5 * 3.75, 1e-12);
  EXPECT_NEAR(sample_clamped(grid, Vec3(3, 4, 5)), 1 + 6 - 12 + 25, 1e-12);
  EXPECT_NEAR(sample_clamped(grid, Vec3(-7, 9, 5.5)), 1 + 0 - 12 + 25, 1e-12);
}

}  // namespace
}  // namespace spinaltap
