#include "core/segment/threshold_mask.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/base/error.h"
#include "core/base/random.h"
#include "tests/unit/core/ct/error_of.h"

namespace spinaltap {
namespace {

using test::error_of;
using testing::HasSubstr;

/// A CT around the origin whose numbers are `hu(p)` plus normal noise.
CtVolume ct_of(const std::function<double(const Vec3&)>& hu, double noise_hu, std::uint64_t seed,
               const std::array<int, 3>& size = {72, 72, 56}, const Vec3& spacing_mm = Vec3(0.5, 0.5, 0.625)) {
  GridGeometry geometry;
  geometry.size = size;
  geometry.spacing_mm = spacing_mm;
  geometry.origin_mm = -0.5 * Vec3(size[0] - 1, size[1] - 1, size[2] - 1).cwiseProduct(spacing_mm);
  std::vector<std::int16_t> voxels;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        const double value = hu(geometry.to_patient(Vec3(i, j, k))) + noise_hu * random_normal(seed, voxels.size());
        voxels.push_back(static_cast<std::int16_t>(std::lround(std::clamp(value, -1024.0, 3071.0))));
      }
    }
  }
  return make_ct_volume(geometry, std::move(voxels));
}

/// A ball of radius 14 mm: a shell of 2 mm at 800 HU around marrow of 60 HU, with a hole of radius `hole_mm` on top.
double hollow_ball(const Vec3& p, double hole_mm) {
  const double r = p.norm();
  if (r > 14.0) return 0.0;
  if (r < 12.0 || (p.z() > 0.0 && std::hypot(p.x(), p.y()) < hole_mm)) return 60.0;
  return 800.0;
}

std::size_t wrong_voxels(const BoneMask& mask, double margin_mm,
                         const std::function<double(const Vec3&)>& distance_mm) {
  std::size_t wrong = 0;
  for (int k = 0; k < mask.geometry.size[2]; ++k) {
    for (int j = 0; j < mask.geometry.size[1]; ++j) {
      for (int i = 0; i < mask.geometry.size[0]; ++i) {
        const double distance = distance_mm(mask.geometry.to_patient(Vec3(i, j, k)));
        if (std::abs(distance) > margin_mm && mask.at(i, j, k) != (distance < 0.0)) ++wrong;
      }
    }
  }
  return wrong;
}

TEST(ThresholdMask, FillsAHollowNoisyBallWithAHoleInItsShell) {
  constexpr std::uint64_t kSeed = 42;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const CtVolume ct = ct_of([](const Vec3& p) { return hollow_ball(p, 0.7); }, 25.0, kSeed);
  const BoneMask mask = threshold_mask(ct);
  // Within a voxel of the surface noise and blur may decide; and over the hole the ball sinks in.
  EXPECT_EQ(wrong_voxels(mask, 0.9, [](const Vec3& p) { return p.norm() - 14.0; }), 0U);
}

TEST(ThresholdMask, LeavesAShellOpenThatHasALargeHole) {
  const CtVolume ct = ct_of([](const Vec3& p) { return hollow_ball(p, 4.0); }, 0.0, 1);
  const BoneMask mask = threshold_mask(ct);
  EXPECT_FALSE(mask.at(36, 36, 28));
  EXPECT_TRUE(mask.at(36, 36, 6));  // the shell's bottom, 13.4 mm below the centre
}

TEST(ThresholdMask, KeepsTheHoleOfATorus) {
  constexpr std::uint64_t kSeed = 43;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const auto distance_mm = [](const Vec3& p) { return std::hypot(std::hypot(p.x(), p.y()) - 9.0, p.z()) - 4.0; };
  const CtVolume ct = ct_of([&](const Vec3& p) { return distance_mm(p) < 0.0 ? 700.0 : 0.0; }, 25.0, kSeed);
  EXPECT_EQ(wrong_voxels(threshold_mask(ct), 0.9, distance_mm), 0U);
}

TEST(ThresholdMask, KeepsTheLargestPartOnly) {
  const Vec3 other_mm(12.0, 12.0, 0.0);
  const CtVolume ct =
      ct_of([&](const Vec3& p) { return p.norm() < 8.0 || (p - other_mm).norm() < 4.0 ? 700.0 : 0.0; }, 0.0, 1);
  EXPECT_EQ(wrong_voxels(threshold_mask(ct), 0.9, [](const Vec3& p) { return p.norm() - 8.0; }), 0U);
}

TEST(ThresholdMask, CountsTheThresholdItselfAsBone) {
  const CtVolume ct = ct_of([](const Vec3& p) { return p.norm() < 5.0 ? 200.0 : 199.0; }, 0.0, 1, {24, 24, 24});
  const BoneMask mask = threshold_mask(ct, {.threshold_hu = 200.0, .smooth_voxels = 0.0});
  EXPECT_TRUE(mask.at(12, 12, 12));
  EXPECT_FALSE(mask.at(0, 0, 0));
}

TEST(ThresholdMask, GivesTheSameAtAnyNumberOfThreads) {
  const CtVolume ct = ct_of([](const Vec3& p) { return hollow_ball(p, 0.7); }, 60.0, 44);
  BoneMask one;
  {
    const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
    one = threshold_mask(ct);
  }
  const tbb::global_control parallel(tbb::global_control::max_allowed_parallelism, 2);
  EXPECT_EQ(threshold_mask(ct).inside, one.inside);
}

TEST(ThresholdMask, SaysWhatTheCtHoldsWhenNothingIsOverTheThreshold) {
  const CtVolume ct = ct_of([](const Vec3& p) { return p.x() < 0.0 ? -90.0 : 140.0; }, 0.0, 1, {8, 8, 8});
  EXPECT_THAT(error_of([&] { threshold_mask(ct, {.threshold_hu = 250.0}); }),
              testing::AllOf(HasSubstr("250 HU"), HasSubstr("-90 to 140 HU")));
}

TEST(ThresholdMask, RefusesOptionsWithoutSense) {
  const CtVolume ct = ct_of([](const Vec3& p) { return p.norm() < 2.0 ? 800.0 : 0.0; }, 0.0, 1, {16, 16, 16});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_THROW(threshold_mask(ct, {.threshold_hu = nan}), Error);
  EXPECT_THROW(threshold_mask(ct, {.threshold_hu = infinite}), Error);
  for (const double bad : {nan, infinite, 1e6}) {
    EXPECT_THROW(threshold_mask(ct, {.smooth_voxels = bad}), Error) << bad;
    EXPECT_THROW(threshold_mask(ct, {.seal_mm = bad}), Error) << bad;
  }
  EXPECT_THROW(threshold_mask(ct, {.seal_mm = -1.0}), Error);
}

TEST(EstimateNoise, FindsTheDeviationInSoftTissueBesideBoneAndAir) {
  constexpr std::uint64_t kSeed = 45;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const auto anatomy = [](const Vec3& p) { return p.norm() < 8.0 ? 900.0 : p.x() > 14.0 ? -1000.0 : 40.0; };
  for (const double noise_hu : {5.0, 12.0, 30.0, 60.0}) {
    // Numbers are whole HU: half a unit of the median is 10% of 5 HU and less of more.
    EXPECT_NEAR(estimate_noise_hu(ct_of(anatomy, noise_hu, kSeed)), noise_hu, 0.1 * noise_hu);
  }
}

TEST(EstimateNoise, IsZeroWithoutSoftTissueAndWithoutNoise) {
  EXPECT_EQ(estimate_noise_hu(ct_of([](const Vec3&) { return 1500.0; }, 20.0, 1, {8, 8, 8})), 0.0);
  EXPECT_EQ(estimate_noise_hu(ct_of([](const Vec3&) { return 40.0; }, 0.0, 1, {8, 8, 8})), 0.0);
}

}  // namespace
}  // namespace spinaltap
