#include "core/force/detail/way_average.h"

#include <gtest/gtest.h>

#include <cmath>

namespace spinaltap {
namespace {

WayAverage::Sums sums(double value) {
  WayAverage::Sums sum;
  sum << value, 2.0 * value, 3.0 * value, -value, 0.5 * value;
  return sum;
}

TEST(WayAverage, IsTheRateOfWhatComesEvenlyWhateverTheStep) {
  for (const double step_mm : {0.0001, 0.003, 0.05, 0.17, 3.0}) {
    WayAverage average(0.2, 24);
    for (double way_mm = 0.0; way_mm < 0.5; way_mm += step_mm) average.add(step_mm, sums(7.0 * step_mm));
    EXPECT_NEAR((average.per_mm() - sums(7.0)).norm(), 0.0, 1e-9) << step_mm;
  }
}

TEST(WayAverage, LetsNothingThroughOfBurstsThatComeAWholeNumberOfTimesABox) {
  for (const double period_mm : {0.2, 0.1, 0.05, 0.04}) {
    constexpr int kBins = 48;
    WayAverage average(0.2, kBins);
    constexpr double kStepMm = 0.0005;
    const int period = static_cast<int>(std::lround(period_mm / kStepMm));
    for (int n = 1; n <= 4'000; ++n) {
      average.add(kStepMm, sums(n % period == 0 ? period_mm : 0.0));
      // What comes within a bin counts as spread over it. At the triangle's top, whose slope changes by twice a box's
      // worth, that takes an eighth of a bin times the change: 1 / (4 bins); at both feet as much together.
      if (n * kStepMm > 0.5) {
        ASSERT_NEAR(average.per_mm()[0], 1.0, 1.0 / (2.0 * kBins)) << n;
      }
    }
  }
}

TEST(WayAverage, TakesABurstInAndOutAsATriangle) {
  WayAverage average(0.2, 200);
  average.add(1.0, sums(0.0));
  average.add(1e-6, sums(1.0));
  double back_mm = 1e-6;
  double integral = 0.0;
  for (int n = 0; n < 500; ++n) {
    average.add(0.001, sums(0.0));
    back_mm += 0.001;
    const double expected = back_mm < 0.2 ? back_mm / 0.04 : std::max(0.0, (0.4 - back_mm) / 0.04);
    EXPECT_NEAR(average.per_mm()[0], expected, 0.03) << back_mm;
    EXPECT_EQ(average.per_mm()[1], 2.0 * average.per_mm()[0]);
    integral += 0.001 * average.per_mm()[0];
  }
  EXPECT_NEAR(integral, 1.0, 1e-3);  // nothing is lost
}

TEST(WayAverage, KeepsWhatComesWithoutAWayForTheNext) {
  WayAverage average(0.2, 24);
  average.add(0.5, sums(0.0));
  average.add(0.0, sums(1.0));
  EXPECT_TRUE(average.per_mm().allFinite());
  double integral = 0.0;
  for (int n = 0; n < 600; ++n) {
    average.add(0.001, sums(0.0));
    integral += 0.001 * average.per_mm()[0];
  }
  EXPECT_NEAR(integral, 1.0, 0.02);
}

TEST(WayAverage, IsEmptyAfterReset) {
  WayAverage average(0.2, 24);
  average.add(0.3, sums(4.0));
  EXPECT_GT(average.per_mm()[0], 1.0);
  average.reset();
  EXPECT_EQ(average.per_mm(), WayAverage::Sums::Zero());
}

}  // namespace
}  // namespace spinaltap
