#include "core/base/text_fields.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

namespace spinaltap {
namespace {

TEST(ParseNumbers, TakesNumbersWithBlanksBetweenAndNothingElse) {
  EXPECT_EQ(parse_numbers(" 1 -2.5\t3e2 "), (std::vector<double>{1.0, -2.5, 300.0}));
  EXPECT_EQ(parse_numbers(""), std::vector<double>());
  EXPECT_FALSE(parse_numbers("1 2,5"));
  EXPECT_FALSE(parse_numbers("1 two"));
}

TEST(NumberText, IsANumberAsAWholeOrNotAtAll) {
  EXPECT_EQ(parse_number("1.5"), 1.5);
  EXPECT_EQ(parse_number(" \t+2e-3 "), 0.002);
  EXPECT_EQ(parse_number("-.5"), -0.5);
  EXPECT_EQ(parse_number("inf"), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(parse_number("nan").value()));
  for (const char* text : {"", " ", "+", "-", "+-1", "--1", "++1", "1,5", "1.5mm", "0x1p3", "1e999", "one"}) {
    EXPECT_FALSE(parse_number(text)) << text;
  }
}

TEST(NumberText, GivesEveryDoubleBack) {
  constexpr std::uint64_t kSeed = 4;
  std::mt19937_64 random(kSeed);
  for (int n = 0; n < 10'000; ++n) {
    const double number = std::bit_cast<double>(random());
    if (!std::isfinite(number)) continue;
    std::string text;
    append_number(number, text);
    ASSERT_EQ(parse_number(text), number) << text << ", seed " << kSeed;
  }
}

TEST(NumberText, HasLettersOfOneCase) {
  EXPECT_EQ(lower_case("L3.SEG.NRRD \xC4 9_"), "l3.seg.nrrd \xC4 9_");  // bytes beyond ASCII are no letters here
  EXPECT_EQ(upper_case("th12, \xE4"), "TH12, \xE4");
}

TEST(NumberText, IsQuotedOnOneShortLine) {
  EXPECT_EQ(in_quotes("x,y"), "\"x,y\"");
  EXPECT_EQ(in_quotes(std::string_view("a\n\0\xff", 4)), "\"a???\"");
  EXPECT_EQ(in_quotes(std::string(40, 'x')), '"' + std::string(40, 'x') + '"');
  EXPECT_EQ(in_quotes(std::string(50, 'x')), '"' + std::string(40, 'x') + "...\"");
  EXPECT_EQ(in_quotes("p\u00e9dicule"), "\"p\u00e9dicule\"");
  EXPECT_EQ(in_quotes("\x1b[2J\u009b\x7f\xc3"), "\"?[2J???\"");  // neither steers the terminal, nor is cut short
  std::string long_name;
  for (int n = 0; n < 41; ++n) long_name += "\u690e";
  EXPECT_EQ(in_quotes(long_name), '"' + long_name.substr(0, 40 * std::string("\u690e").size()) + "...\"");
}

}  // namespace
}  // namespace spinaltap
