#include "core/segment/bone_levels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/base/error.h"
#include "core/base/random.h"
#include "tests/support/error_of.h"

namespace spinaltap {
namespace {

using test::error_of;
using testing::HasSubstr;

/// A CT around the origin whose numbers are `hu(p)` plus normal noise.
CtVolume ct_of(const std::function<double(const Vec3&)>& hu, double noise_hu, std::uint64_t seed) {
  GridGeometry geometry;
  geometry.size = {64, 64, 48};
  geometry.spacing_mm = Vec3(0.5, 0.5, 0.625);
  geometry.origin_mm = -0.5 * Vec3(63.0, 63.0, 47.0).cwiseProduct(geometry.spacing_mm);
  std::vector<std::int16_t> voxels;
  for (int k = 0; k < 48; ++k) {
    for (int j = 0; j < 64; ++j) {
      for (int i = 0; i < 64; ++i) {
        const double value = hu(geometry.to_patient(Vec3(i, j, k))) + noise_hu * random_normal(seed, voxels.size());
        voxels.push_back(static_cast<std::int16_t>(std::lround(std::clamp(value, -1024.0, 3071.0))));
      }
    }
  }
  return make_ct_volume(geometry, std::move(voxels));
}

double bone_beside_air(const Vec3& p) { return p.norm() < 8.0 ? 900.0 : p.x() > 14.0 ? -1000.0 : 40.0; }

TEST(EstimateNoise, FindsTheDeviationInSoftTissueBesideBoneAndAir) {
  constexpr std::uint64_t kSeed = 45;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  for (const double noise_hu : {5.0, 12.0, 30.0, 60.0}) {
    // Numbers are whole HU: half a unit of the median is 10% of 5 HU and less of more.
    EXPECT_NEAR(estimate_noise_hu(ct_of(bone_beside_air, noise_hu, kSeed)), noise_hu, 0.1 * noise_hu);
  }
}

TEST(EstimateNoise, IsZeroWithoutSoftTissueAndWithoutNoise) {
  EXPECT_EQ(estimate_noise_hu(ct_of([](const Vec3&) { return 1500.0; }, 20.0, 1)), 0.0);
  EXPECT_EQ(estimate_noise_hu(ct_of([](const Vec3&) { return 40.0; }, 0.0, 1)), 0.0);
}

TEST(ChooseBoneLevels, GoesLowerAndBlursMoreTheMoreNoiseThereIs) {
  const BoneLevels quiet = choose_bone_levels(ct_of(bone_beside_air, 5.0, 1));
  const BoneLevels noisy = choose_bone_levels(ct_of(bone_beside_air, 80.0, 1));
  EXPECT_EQ(quiet.low_hu, 150.0);
  EXPECT_EQ(noisy.low_hu, 115.0);
  EXPECT_LT(quiet.blur_voxels, 0.1);
  EXPECT_GT(noisy.blur_voxels, 0.5);
}

TEST(ChooseBoneLevels, PutsTheSureLevelAThirdOfTheWayToTheCortex) {
  // All bone has 900 HU: 150 + (900 - 150) / 3.
  EXPECT_NEAR(choose_bone_levels(ct_of(bone_beside_air, 0.0, 1)).sure_hu, 400.0, 1e-9);
}

TEST(ChooseBoneLevels, TakesTheThresholdThatIsGiven) {
  const CtVolume ct = ct_of(bone_beside_air, 0.0, 1);
  EXPECT_EQ(choose_bone_levels(ct, 220.0).low_hu, 220.0);
  EXPECT_EQ(choose_bone_levels(ct, 900.0).low_hu, 900.0);  // the threshold itself is bone
  EXPECT_THAT(error_of([&] { choose_bone_levels(ct, 901.0); }),
              testing::AllOf(HasSubstr("901 HU"), HasSubstr("-1000 to 900 HU")));
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(choose_bone_levels(ct, bad), Error);
  }
}

}  // namespace
}  // namespace spinaltap
