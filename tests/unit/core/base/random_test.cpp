#include "core/base/random.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace spinaltap {
namespace {

TEST(MixBits, IsSplitMix64) {
  // The first outputs of the published generator from seed 1234567.
  EXPECT_EQ(mix_bits(1234567), 6457827717110365317ULL);
  EXPECT_EQ(mix_bits(1234567 + 0x9e3779b97f4a7c15ULL), 3203168211198807973ULL);
}

TEST(RandomUniform, FillsTheUnitIntervalEvenly) {
  constexpr int kCount = 100'000;
  for (const std::uint64_t seed : {0ULL, 1ULL, 2026ULL}) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    std::array<int, 20> bins{};
    double lagged = 0.0;
    for (int i = 0; i < kCount; ++i) {
      const double u = random_uniform(seed, static_cast<std::uint64_t>(i));
      ASSERT_GE(u, 0.0);
      ASSERT_LT(u, 1.0);
      ++bins[static_cast<std::size_t>(20.0 * u)];
      lagged += (u - 0.5) * (random_uniform(seed, static_cast<std::uint64_t>(i) + 1) - 0.5);
    }
    // Five standard deviations: of a bin sqrt(100,000 * 0.05 * 0.95) = 69; of the mean product (1/12) / sqrt(100,000).
    for (const int bin : bins) EXPECT_NEAR(bin, kCount / 20, 345);
    EXPECT_NEAR(lagged / kCount, 0.0, 5.0 / 12.0 / std::sqrt(kCount));
  }
}

TEST(RandomNormal, HasTheMomentsOfAStandardNormal) {
  constexpr int kCount = 200'000;
  for (const std::uint64_t seed : {0ULL, 7ULL}) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    std::array<double, 4> moments{};
    for (int i = 0; i < kCount; ++i) {
      const double x = random_normal(seed, static_cast<std::uint64_t>(i));
      for (int power = 1; power <= 4; ++power)
        moments[static_cast<std::size_t>(power - 1)] += std::pow(x, power) / kCount;
    }
    // Five standard deviations: variances of x, x², x³, x⁴ are 1, 2, 15, 96.
    const double root = std::sqrt(kCount);
    EXPECT_NEAR(moments[0], 0.0, 5.0 / root);
    EXPECT_NEAR(moments[1], 1.0, 5.0 * std::sqrt(2.0) / root);
    EXPECT_NEAR(moments[2], 0.0, 5.0 * std::sqrt(15.0) / root);
    EXPECT_NEAR(moments[3], 3.0, 5.0 * std::sqrt(96.0) / root);
  }
}

TEST(Random, DependsOnSeedAndIndexAlone) {
  const double first = random_normal(3, 1'000'000);
  random_normal(3, 5);
  EXPECT_EQ(random_normal(3, 1'000'000), first);
  EXPECT_NE(random_normal(4, 1'000'000), first);
  EXPECT_NE(random_normal(3, 1'000'001), first);
}

}  // namespace
}  // namespace spinaltap
