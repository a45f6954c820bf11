#include "core/ct/detail/dicom_values.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

using testing::ElementsAre;
using testing::IsNan;

TEST(DicomDecimal, ReadsListsWithSpacesAndSigns) {
  EXPECT_THAT(parse_decimal_string("-30\\ 135 \\+1.5e1"), ElementsAre(-30.0, 135.0, 15.0));
  EXPECT_TRUE(parse_decimal_string("").empty());
  EXPECT_THAT(parse_decimal_string("1\\\\x2\\3 4"), ElementsAre(1.0, IsNan(), IsNan(), IsNan()));
}

TEST(DicomDecimal, WritesTheShortestExactText) {
  EXPECT_EQ(to_decimal_string(1.5), "1.5");
  EXPECT_EQ(to_decimal_string(-103.2), "-103.2");
  EXPECT_EQ(to_decimal_string(-0.0), "0");
}

TEST(DicomDecimal, FitsSixteenCharactersAndLosesLittle) {
  constexpr std::uint64_t kSeed = 7;
  for (std::uint64_t n = 0; n < 10000; ++n) {
    const double value =
        (random_uniform(kSeed, 2 * n) - 0.5) * std::pow(10.0, 12.0 * random_uniform(kSeed, 2 * n + 1) - 6.0);
    const std::string text = to_decimal_string(value);
    ASSERT_LE(text.size(), 16u) << text;
    // At worst a sign, a point and an exponent of four leave ten digits.
    ASSERT_NEAR(parse_decimal_string(text).at(0), value, 1e-9 * std::abs(value)) << text << ", seed " << kSeed;
  }
}

TEST(DicomDecimal, RejectsToWriteWhatIsNoNumber) {
  EXPECT_THROW(to_decimal_string(std::numeric_limits<double>::quiet_NaN()), Error);
}

}  // namespace
}  // namespace spinaltap
