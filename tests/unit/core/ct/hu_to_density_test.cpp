#include "core/ct/hu_to_density.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(HuToDensity, IsALineThatEndsAtZero) {
  const HuToDensity line{0.1, 0.001};
  EXPECT_NEAR(line.density_g_cm3(900.0), 1.0, 1e-15);
  EXPECT_NEAR(line.density_g_cm3(0.0), 0.1, 1e-15);
  EXPECT_EQ(line.density_g_cm3(-100.1), 0.0);
  EXPECT_EQ(line.density_g_cm3(-1024.0), 0.0);
}

TEST(HuToDensity, NeverFallsAsTheNumberRises) {
  const HuToDensity line;
  for (int hu = -1024; hu < 4096; ++hu) ASSERT_LE(line.density_g_cm3(hu), line.density_g_cm3(hu + 1)) << hu;
}

TEST(HuToDensity, IsRejectedWhereItMakesNoSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {nan, std::numeric_limits<double>::infinity(), -1.5, 1e6}) {
    EXPECT_THROW(check_hu_to_density({bad, 0.001}), Error) << bad;
    EXPECT_THROW(check_hu_to_density({0.05, bad}), Error) << bad;
  }
  EXPECT_THROW(check_hu_to_density({0.05, 0.0}), Error);
  EXPECT_NO_THROW(check_hu_to_density({}));
}

TEST(DensityCalibration, FindsTheLineThatThePairsLieOn) {
  // Rods of 0, 50, 100 and 200 mg/cm³ on a line.
  std::vector<CalibrationPair> pairs;
  for (const double density : {0.0, 0.05, 0.1, 0.2}) pairs.push_back({(density + 0.012) / 0.0008, density});
  const DensityCalibration calibration = calibrate_density(pairs);
  EXPECT_NEAR(calibration.line.at_0_hu, -0.012, 1e-15);
  EXPECT_NEAR(calibration.line.per_hu, 0.0008, 1e-17);
  EXPECT_NEAR(calibration.max_residual_g_cm3, 0.0, 1e-15);
}

TEST(DensityCalibration, MissesPairsOffTheLineByLeastSquares) {
  // By hand: three pairs at 0, 1000 and 2000 HU; the middle one 0.3 above the line through the others lifts the line by
  // a third of that.
  const DensityCalibration calibration =
      calibrate_density(std::vector<CalibrationPair>{{0.0, 0.1}, {1000.0, 1.4}, {2000.0, 2.1}});
  EXPECT_NEAR(calibration.line.per_hu, 0.001, 1e-15);
  EXPECT_NEAR(calibration.line.at_0_hu, 0.2, 1e-15);
  EXPECT_NEAR(calibration.max_residual_g_cm3, 0.2, 1e-14);
  EXPECT_NEAR(calibration.rms_residual_g_cm3, std::sqrt((0.01 + 0.04 + 0.01) / 3.0), 1e-14);
}

TEST(DensityCalibration, NeedsTwoNumbersAndARisingLine) {
  using Pairs = std::vector<CalibrationPair>;
  EXPECT_THAT([] { calibrate_density({}); }, ThrowsMessage<Error>(HasSubstr("two pairs")));
  EXPECT_THAT([] { calibrate_density(Pairs{{100.0, 0.1}}); }, ThrowsMessage<Error>(HasSubstr("two pairs")));
  EXPECT_THAT(
      [] {
        calibrate_density(Pairs{{100.0, 0.1}, {100.0, 0.2}, {100.0, 0.3}});
      },
      ThrowsMessage<Error>(HasSubstr("two pairs")));
  EXPECT_THAT([] { calibrate_density(Pairs{{100.0, 0.2}, {200.0, 0.1}}); }, ThrowsMessage<Error>(HasSubstr("rise")));
  EXPECT_THAT([] { calibrate_density(Pairs{{100.0, 0.2}, {200.0, 0.2}}); }, ThrowsMessage<Error>(HasSubstr("rise")));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(calibrate_density(Pairs{{nan, 0.1}, {200.0, 0.2}}), Error);
  EXPECT_THROW(calibrate_density(Pairs{{100.0, nan}, {200.0, 0.2}}), Error);
  EXPECT_THROW(calibrate_density(Pairs{{100.0, -0.1}, {200.0, 0.2}}), Error);
}

}  // namespace
}  // namespace spinaltap
