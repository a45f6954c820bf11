#include "core/base/statistics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {
namespace {

TEST(NormalQuantile, InvertsTheDistributionEverywhere) {
  // The C library's complementary error function is the distribution itself; both tails, so that neither is 1 - small.
  for (const double p : {1e-300, 1e-100, 1e-20, 1e-12, 1e-6, 0.001, 0.025, 0.0749, 0.0751, 0.2, 0.4, 0.49999, 0.5}) {
    const double x = normal_quantile(p);
    const double back = 0.5 * std::erfc(-x / std::sqrt(2.0));
    // An error of 1 ulp in x is x² ulp in p.
    EXPECT_NEAR(back / p, 1.0, 1e-14 + 4e-16 * x * x) << p;
  }
  for (const double p : {0.001, 0.1, 0.3, 0.45}) EXPECT_NEAR(normal_quantile(1.0 - p), -normal_quantile(p), 1e-13);
}

TEST(NormalQuantile, IsWhatTablesSay) {
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-15);
  EXPECT_NEAR(normal_quantile(0.995), 2.5758293035489004, 1e-15);
  EXPECT_EQ(normal_quantile(0.5), 0.0);
}

TEST(NormalQuantile, RejectsWhatHasNone) {
  for (const double p : {0.0, 1.0, -0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(normal_quantile(p), Error) << p;
  }
}

TEST(WilsonInterval, IsWhatNewcombePublished) {
  // Newcombe, "Two-sided confidence intervals for the single proportion", Stat. Med. 1998, table I, method 3.
  struct Case {
    std::size_t successes, trials;
    double low, high;
  };
  for (const Case& known : {Case{81, 263, 0.2553, 0.3662}, Case{15, 148, 0.0624, 0.1605}, Case{0, 20, 0.0, 0.1611},
                            Case{1, 29, 0.0061, 0.1718}}) {
    const Interval found = wilson_interval(known.successes, known.trials);
    EXPECT_NEAR(found.low, known.low, 0.00005) << known.successes << " of " << known.trials;
    EXPECT_NEAR(found.high, known.high, 0.00005) << known.successes << " of " << known.trials;
  }
}

TEST(WilsonInterval, EndsWhereTheScoreTestWouldJustReject) {
  // That is its definition: |p - end| = z sqrt(end (1 - end) / n).
  const double z = normal_quantile(0.95);
  for (const std::size_t successes : {std::size_t{3}, std::size_t{40}, std::size_t{77}}) {
    const Interval found = wilson_interval(successes, 80, 0.9);
    const double p = static_cast<double>(successes) / 80.0;
    for (const double end : {found.low, found.high}) {
      EXPECT_NEAR(std::abs(p - end), z * std::sqrt(end * (1.0 - end) / 80.0), 1e-12);
    }
  }
}

TEST(WilsonInterval, StaysWithinZeroAndOne) {
  EXPECT_EQ(wilson_interval(0, 50).low, 0.0);
  EXPECT_EQ(wilson_interval(50, 50).high, 1.0);
  EXPECT_EQ(wilson_interval(0, 0).low, 0.0);
  EXPECT_EQ(wilson_interval(0, 0).high, 1.0);
  EXPECT_THROW(wilson_interval(3, 2), Error);
  EXPECT_THROW(wilson_interval(1, 2, 1.0), Error);
  EXPECT_THROW(wilson_interval(1, 2, std::nan("")), Error);
}

TEST(StudentQuantile, IsThatOfTheTables) {
  struct Known {
    double probability;
    int degrees;
    double quantile;
  };
  // One and two degrees in closed form: tan(pi (p - 1/2)), and (2 p - 1) / sqrt(2 p (1 - p)); the others are tables'.
  for (const Known& known :
       {Known{0.95, 1, std::tan(std::numbers::pi * 0.45)}, Known{0.95, 2, 0.9 / std::sqrt(2.0 * 0.95 * 0.05)},
        Known{0.95, 6, 1.943180281}, Known{0.95, 9, 1.833112933}, Known{0.975, 10, 2.228138852},
        Known{0.995, 30, 2.749995654}}) {
    EXPECT_NEAR(student_quantile(known.probability, known.degrees), known.quantile, 2e-9 * known.quantile);
    EXPECT_NEAR(student_quantile(1.0 - known.probability, known.degrees), -known.quantile, 2e-9 * known.quantile);
  }
  EXPECT_EQ(student_quantile(0.5, 4), 0.0);
  EXPECT_NEAR(student_quantile(0.95, 1000), normal_quantile(0.95), 2e-3);
  for (const double bad : {0.0, 1.0, std::nan("")}) EXPECT_THROW(student_quantile(bad, 4), Error);
  EXPECT_THROW(student_quantile(0.5, 0), Error);
}

TEST(Quantile, LiesBetweenTheOrderStatisticsAsInNumpy) {
  // numpy.quantile([1, 2, 4, 8], q)
  const std::vector<double> sample{1.0, 2.0, 4.0, 8.0};
  const std::array<std::pair<double, double>, 6> known{
      {{0.0, 1.0}, {0.25, 1.75}, {0.5, 3.0}, {0.75, 5.0}, {0.9, 6.8}, {1.0, 8.0}}};
  for (const auto& [share, value] : known) EXPECT_NEAR(quantile(sample, share), value, 1e-14) << share;
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
  EXPECT_THROW(quantile(sample, 1.1), Error);
  EXPECT_THROW(quantile(sample, std::nan("")), Error);
}

}  // namespace
}  // namespace spinaltap
