#include "apps/report/png.h"

#include <gtest/gtest.h>

namespace spinaltap {
namespace {

// RFC 4648, section 10.
TEST(Base64, MatchesTheTestVectorsOfItsStandard) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(Base64, TakesBytesAbove127AndZeros) { EXPECT_EQ(base64(std::string_view("\xFF\xFE\x00\xFB", 4)), "//4A+w=="); }

}  // namespace
}  // namespace spinaltap
