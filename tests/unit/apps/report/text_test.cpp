#include "apps/report/text.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/error.h"

namespace spinaltap {
namespace {

TEST(ReportText, EscapesEverythingThatHtmlGivesAMeaning) {
  EXPECT_EQ(escape_html("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
}

TEST(ReportText, KeepsValidUtf8) { EXPECT_EQ(escape_html("Wirbelsäule µm ≤ 🦴"), "Wirbelsäule µm ≤ 🦴"); }

TEST(ReportText, ReplacesControlCharactersAndBytesThatAreNotUtf8) {
  EXPECT_EQ(escape_html(std::string_view("a\0b", 3)), "a\uFFFDb");
  EXPECT_EQ(escape_html("a\x1B[31m"), "a\uFFFD[31m");
  EXPECT_EQ(escape_html("\xFF<"), "\uFFFD&lt;");
  EXPECT_EQ(escape_html("\xE2\x82"), "\uFFFD\uFFFD");            // cut short
  EXPECT_EQ(escape_html("\xC0\xBC"), "\uFFFD\uFFFD");            // an overlong "<"
  EXPECT_EQ(escape_html("\xED\xA0\x80"), "\uFFFD\uFFFD\uFFFD");  // a surrogate
}

TEST(ReportText, WritesCoordinatesShortAndWithoutMinusZero) {
  EXPECT_EQ(svg_number(12.0), "12");
  EXPECT_EQ(svg_number(0.5), "0.5");
  EXPECT_EQ(svg_number(-0.001), "0");
  EXPECT_EQ(svg_number(-1.256), "-1.26");
  EXPECT_EQ(svg_number(100.0, 0), "100");
  EXPECT_THROW(svg_number(std::numeric_limits<double>::quiet_NaN()), Error);
}

TEST(ReportText, SetsThousandsApart) {
  EXPECT_EQ(readable_number(986958, 0), "986,958");
  EXPECT_EQ(readable_number(-1234567.891, 2), "-1,234,567.89");
  EXPECT_EQ(readable_number(-123.4, 1), "-123.4");
  EXPECT_EQ(readable_number(999.0, 1), "999.0");
  EXPECT_EQ(readable_number(std::numeric_limits<double>::infinity(), 1), "n/a");
}

}  // namespace
}  // namespace spinaltap
