#include "apps/report/depth_bins.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "tests/support/nan.h"

namespace spinaltap {
namespace {

using test::kNan;

TEST(DepthBins, HoldMinMedianAndMaxOfEachStretch) {
  const std::vector<double> depth{0, 1, 2, 3, 4, 5, 6, 8};
  const std::vector<double> values{5, 1, 3, 7, 10, 40, 20, 30};
  const DepthBins bins = bin_by_depth(depth, values, 2);
  EXPECT_EQ(bins.depth, (std::vector<double>{2, 6}));
  EXPECT_EQ(bins.min, (std::vector<double>{1, 10}));
  EXPECT_EQ(bins.median, (std::vector<double>{4, 25}));
  EXPECT_EQ(bins.max, (std::vector<double>{7, 40}));
}

TEST(DepthBins, PassOverValuesThatAreNotFinite) {
  const DepthBins bins =
      bin_by_depth(std::vector<double>{0, 1, 9, kNan, 10}, std::vector<double>{kNan, kNan, 4, 1, 6}, 2);
  EXPECT_TRUE(std::isnan(bins.median[0]));
  EXPECT_EQ(bins.median[1], 5.0);
  EXPECT_TRUE(bin_by_depth({}, {}, 3).depth.empty());
  EXPECT_EQ(bin_by_depth(std::vector<double>{2, 2}, std::vector<double>{1, 3}, 1).median[0], 2.0);
}

TEST(DepthBins, RejectUnequalLengthsAndNoBins) {
  EXPECT_THROW(bin_by_depth(std::vector<double>{1}, {}, 2), Error);
  EXPECT_THROW(bin_by_depth({}, {}, 0), Error);
}

}  // namespace
}  // namespace spinaltap
