#include "core/surface/surface_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/point_grid.h"
#include "core/surface/pixel_points.h"
#include "tests/support/release_only.h"

namespace spinaltap {
namespace {

GridGeometry small_grid() {
  GridGeometry geometry;
  geometry.size = {9, 8, 3};
  geometry.spacing_mm = Vec3(0.4, 0.5, 0.7);
  geometry.origin_mm = Vec3(10, 20, 30);
  return geometry;
}

/// Voxels i = 2...6, j = 2...5 in slice 1.
BoneMask plate() {
  BoneMask mask{small_grid(), {}};
  mask.inside.assign(mask.geometry.voxel_count(), 0);
  for (int j = 2; j <= 5; ++j) {
    for (int i = 2; i <= 6; ++i) mask.inside[mask.geometry.offset(i, j, 1)] = 1;
  }
  return mask;
}

CtVolume ct_of(const BoneMask& mask) {
  std::vector<std::int16_t> hu;
  for (const std::uint8_t inside : mask.inside) hu.push_back(inside != 0 ? 1000 : 0);
  return make_ct_volume(mask.geometry, std::move(hu));
}

TEST(PixelPoints, AreTheRimOfAPlateInItsSlice) {
  const BoneMask mask = plate();
  const PixelPoints pixels = surface_pixels(mask);
  // 5 x 4 pixels without the 3 x 2 in the middle.
  ASSERT_EQ(pixels.voxels.size(), 14U);
  for (std::size_t n = 0; n < pixels.voxels.size(); ++n) {
    const auto [i, j, k] = pixels.voxels[n];
    EXPECT_EQ(k, 1);
    const Vec3 expected((i == 6 ? 1.0 : 0.0) - (i == 2 ? 1.0 : 0.0), (j == 5 ? 1.0 : 0.0) - (j == 2 ? 1.0 : 0.0), 0.0);
    EXPECT_EQ(pixels.outward[n], expected) << i << " " << j;
  }
}

TEST(PixelPoints, HaveNeighboursOnBothSidesEachOnce) {
  const BoneMask mask = plate();
  const PixelPoints pixels = surface_pixels(mask);
  const PixelNeighbours neighbours = neighbour_pixels(mask, pixels);
  // Outside: a row of 5 or 4 beyond each side. Inside: the 3 x 2 in the middle.
  const auto inside = std::count(neighbours.is_inside.begin(), neighbours.is_inside.end(), true);
  EXPECT_EQ(inside, 6);
  EXPECT_EQ(neighbours.voxels.size(), 18U + 6U);
  auto sorted = neighbours.voxels;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(std::adjacent_find(sorted.begin(), sorted.end()), sorted.end());
}

TEST(PixelPoints, HaveNoDirectionOnALineOneWide) {
  BoneMask mask{small_grid(), {}};
  mask.inside.assign(mask.geometry.voxel_count(), 0);
  for (int j = 2; j <= 6; ++j) mask.inside[mask.geometry.offset(4, j, 1)] = 1;
  const PixelPoints pixels = surface_pixels(mask);
  ASSERT_EQ(pixels.voxels.size(), 5U);
  EXPECT_EQ(pixels.outward[0], Vec3(0, -1, 0));
  EXPECT_EQ(pixels.outward[2], Vec3::Zero());
  // They are dropped, and counted, where a normal is needed.
  const SurfaceSamples samples = sample_surface(ct_of(mask), mask, {.method = PointMethod::normals});
  EXPECT_EQ(samples.dropped, 3U);
  EXPECT_EQ(samples.surface_count, 2U);
}

TEST(PixelPoints, HaveValuesOfOnePixel) {
  const BoneMask mask = plate();
  const SurfaceSamples samples = sample_surface(ct_of(mask), mask, {.method = PointMethod::pixels});
  ASSERT_EQ(samples.positions_mm.size(), 14U + 24U);
  for (std::size_t n = 0; n < samples.positions_mm.size(); ++n) {
    const Vec3 index = mask.geometry.to_index(samples.positions_mm[n]);
    if (n < 14) {
      EXPECT_EQ(samples.values_mm[n], 0.0);
      continue;
    }
    const bool inside = mask.at(static_cast<int>(std::lround(index.x())), static_cast<int>(std::lround(index.y())), 1);
    // The nearest surface pixel lies one pixel away along i (0.4 mm) or along j (0.5 mm).
    double along_i = 1e9, along_j = 1e9;
    for (std::size_t s = 0; s < 14; ++s) {
      const Vec3 way = samples.positions_mm[n] - samples.positions_mm[s];
      if (std::abs(way.y()) < 1e-9) along_i = std::min(along_i, std::abs(way.x()));
      if (std::abs(way.x()) < 1e-9) along_j = std::min(along_j, std::abs(way.y()));
    }
    const double value_mm = std::abs(samples.values_mm[n]);
    EXPECT_TRUE(std::abs(value_mm - along_i) < 1e-9 || std::abs(value_mm - along_j) < 1e-9) << n;
    EXPECT_EQ(samples.values_mm[n] < 0.0, inside) << n;
  }
}

/// Two plates of bone, 3.6 mm thick, 1.2 mm apart: 2 mm off the surface of one lies the other.
void make_two_plates(BoneMask& mask, CtVolume& ct) {
  GridGeometry geometry;
  geometry.size = {40, 40, 30};
  geometry.spacing_mm = Vec3::Constant(0.4);
  mask = {geometry, {}};
  std::vector<std::int16_t> hu;
  for (int k = 0; k < 30; ++k) {
    for (int j = 0; j < 40; ++j) {
      for (int i = 0; i < 40; ++i) {
        const bool within = i >= 8 && i < 32 && k >= 6 && k < 24;
        const bool bone = within && ((j >= 8 && j < 17) || (j >= 20 && j < 29));
        mask.inside.push_back(bone ? 1 : 0);
        hu.push_back(bone ? 1000 : 0);
      }
    }
  }
  ct = make_ct_volume(geometry, std::move(hu));
}

TEST(SurfaceSamples, HaveNoOffSurfacePointNearerToAnotherPart) {
  RELEASE_ONLY();
  BoneMask mask;
  CtVolume ct;
  make_two_plates(mask, ct);
  for (const PointMethod method : {PointMethod::normals, PointMethod::contours}) {
    const SurfaceSamples samples = sample_surface(ct, mask, {.method = method, .off_surface_mm = 2.0});
    const std::span<const Vec3> surface(samples.positions_mm.data(), samples.surface_count);
    const PointGrid grid(surface, 1.0);
    std::size_t shortened = 0;
    ASSERT_GT(samples.positions_mm.size(), samples.surface_count);
    for (std::size_t n = samples.surface_count; n < samples.positions_mm.size(); ++n) {
      const double value_mm = std::abs(samples.values_mm[n]);
      EXPECT_LE(value_mm, 2.0);
      EXPECT_GE(grid.nearest_within(samples.positions_mm[n], 3.0).distance_mm, 0.98 * value_mm - 1e-9);
      shortened += value_mm < 1.9 ? 1U : 0U;
    }
    EXPECT_GT(shortened, 100U);
  }
}

TEST(SurfaceSamples, HaveValuesThatAreTheDistanceAlongTheNormal) {
  BoneMask mask;
  CtVolume ct;
  make_two_plates(mask, ct);
  const SurfaceSamples samples = sample_surface(ct, mask, {.off_surface_mm = 0.4});
  EXPECT_EQ(samples.normals.size(), samples.positions_mm.size());
  std::size_t outside = 0, inside = 0;
  for (std::size_t n = samples.surface_count; n < samples.positions_mm.size(); ++n) {
    const Vec3 back_mm = samples.positions_mm[n] - samples.values_mm[n] * samples.normals[n];
    const std::span<const Vec3> surface(samples.positions_mm.data(), samples.surface_count);
    ++(samples.values_mm[n] > 0.0 ? outside : inside);
    if (n % 500 != 0) continue;
    double nearest_mm = 1e9;
    for (const Vec3& p : surface) nearest_mm = std::min(nearest_mm, (p - back_mm).norm());
    EXPECT_LT(nearest_mm, 1e-9);
  }
  // Both sides, nearly everywhere.
  EXPECT_GT(outside, samples.surface_count * 95 / 100);
  EXPECT_GT(inside, samples.surface_count * 95 / 100);
}

TEST(SurfaceSamples, RejectWhatMakesNoSense) {
  BoneMask mask = plate();
  const CtVolume ct = ct_of(mask);
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(sample_surface(ct, mask, {.method = PointMethod::normals, .off_surface_mm = bad}), Error);
  }
  std::fill(mask.inside.begin(), mask.inside.end(), std::uint8_t{0});
  for (const PointMethod method : {PointMethod::pixels, PointMethod::normals, PointMethod::contours}) {
    EXPECT_THROW(sample_surface(ct, mask, {.method = method}), Error);
  }
}

}  // namespace
}  // namespace spinaltap
