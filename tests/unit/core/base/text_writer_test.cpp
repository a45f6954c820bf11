#include "core/base/text_writer.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <random>

#include "core/base/geometry.h"

namespace spinaltap {
namespace {

TEST(TextWriter, WritesNumbersAsPrintfDoesInTheLocaleOfC) {
  constexpr std::uint64_t kSeed = 8;
  std::mt19937_64 random(kSeed);
  std::vector<double> numbers{0.0, -0.0, 0.5, 2.5, 1e5, 999999.5, 1e6, 1e-5, 12345.678, 1e300, -1.0 / 3.0};
  for (int n = 0; n < 2000; ++n) {
    const double number = std::bit_cast<double>(random());
    if (std::isfinite(number)) numbers.push_back(number);
  }
  numbers.push_back(std::numeric_limits<double>::infinity());
  numbers.push_back(std::numeric_limits<double>::quiet_NaN());
  for (const double number : numbers) {
    for (const int digits : {0, 1, 3, 6, 9}) {
      char expected[400];
      std::snprintf(expected, sizeof expected, "%.*f", digits, number);
      ASSERT_EQ(fixed_text(number, digits), expected) << "seed " << kSeed;
      std::snprintf(expected, sizeof expected, "%.*g", digits, number);
      ASSERT_EQ(short_text(number, digits), expected) << "seed " << kSeed;
    }
  }
}

TEST(TextWriter, JoinsPartsOfEveryKind) {
  const std::string word = "word";
  EXPECT_EQ(joined("a ", word, ' ', std::string_view("view"), ' ', 3, ' ', -4L, ' ', std::size_t{5}, ' ', 0.25, ' ',
                   0.1F, ' ', true),
            "a word view 3 -4 5 0.25 0.1 1");
  EXPECT_EQ(joined(1234567.0, " ", 1234567), "1.23457e+06 1234567");
  EXPECT_EQ(joined(Vec3(1.0, 2.0, 3.0).transpose()), "1 2 3");
  EXPECT_EQ(joined(std::filesystem::path("a b")), "\"a b\"");
  TextWriter coarse(3);
  coarse << 1.23456 << ' ' << 12345;
  EXPECT_EQ(coarse.str(), "1.23 12345");
}

TEST(TextWriter, FillsWholeNumbersWithZeros) {
  EXPECT_EQ(padded_number(7, 4), "0007");
  EXPECT_EQ(padded_number(12345, 4), "12345");
  EXPECT_EQ(padded_number(0, 1), "0");
}

}  // namespace
}  // namespace spinaltap
