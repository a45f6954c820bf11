#include "apps/report/plot_ticks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

/// Whether a step is 1, 2 or 5 times a power of ten.
bool is_round(double step) {
  const double mantissa = step / std::pow(10.0, std::floor(std::log10(step) + 1e-9));
  return std::abs(mantissa - 1) < 1e-9 || std::abs(mantissa - 2) < 1e-9 || std::abs(mantissa - 5) < 1e-9;
}

TEST(PlotTicks, AreRoundEvenAndEncloseTheRange) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const double size = std::pow(10.0, 12.0 * random_uniform(seed, 0) - 6.0);
    const double low = size * (random_uniform(seed, 1) - 0.5);
    const double high = low + size * (0.01 + random_uniform(seed, 2));
    const AxisTicks ticks = linear_ticks(low, high, 6);
    ASSERT_GE(ticks.major.size(), 2U) << "seed " << seed;
    ASSERT_LE(ticks.major.size(), 9U) << "seed " << seed;
    const double step = ticks.major[1] - ticks.major[0];
    EXPECT_TRUE(is_round(step)) << "seed " << seed << ", step " << step;
    EXPECT_LE(ticks.low, low + 1e-8 * step) << "seed " << seed;
    EXPECT_GE(ticks.high, high - 1e-8 * step) << "seed " << seed;
    for (const double value : ticks.major) {
      EXPECT_NEAR(value / step, std::round(value / step), 1e-6) << "seed " << seed;
    }
  }
}

TEST(PlotTicks, WidenARangeWithoutLength) {
  for (const double value : {0.0, 5.0, -3e6, 1e-9}) {
    const AxisTicks ticks = linear_ticks(value, value, 6);
    EXPECT_LT(ticks.low, value);
    EXPECT_GT(ticks.high, value);
  }
}

TEST(PlotTicks, StandAtPowersOfTenOnALogAxis) {
  const AxisTicks wide = log_ticks(3000.0, 2.4e6);
  EXPECT_DOUBLE_EQ(wide.low, 2000.0);
  EXPECT_DOUBLE_EQ(wide.high, 5e6);
  EXPECT_EQ(wide.major, (std::vector<double>{1e4, 1e5, 1e6}));
  const AxisTicks narrow = log_ticks(12.0, 90.0);
  EXPECT_EQ(narrow.major, (std::vector<double>{10, 20, 50, 100}));
  EXPECT_LT(log_ticks(7.0, 7.0).low, log_ticks(7.0, 7.0).high);
  EXPECT_EQ(log_ticks(0.001, 0.01).major, (std::vector<double>{0.001, 0.002, 0.005, 0.01}));
}

TEST(PlotTicks, HaveShortLabels) {
  EXPECT_EQ(tick_label(0.0, 5.0), "0");
  EXPECT_EQ(tick_label(1500.0, 500.0), "1500");
  EXPECT_EQ(tick_label(0.30000000000000004, 0.1), "0.3");
  EXPECT_EQ(tick_label(-2.5, 0.5), "-2.5");
  EXPECT_EQ(tick_label(20000.0, 5000.0), "20\u00A0k");
  EXPECT_EQ(tick_label(1.5e6, 5e5), "1.5\u00A0M");
  EXPECT_EQ(tick_label(1e6, 0.0), "1\u00A0M");
  EXPECT_EQ(tick_label(0.002, 0.0), "0.002");
  EXPECT_EQ(tick_label(2e-6, 1e-6), "2e-6");
}

TEST(PlotTicks, RejectRangesThatCannotBeDrawn) {
  EXPECT_THROW(linear_ticks(0.0, std::numeric_limits<double>::infinity(), 5), Error);
  EXPECT_THROW(log_ticks(0.0, 1.0), Error);
  EXPECT_THROW(log_ticks(std::numeric_limits<double>::quiet_NaN(), 1.0), Error);
}

}  // namespace
}  // namespace spinaltap
