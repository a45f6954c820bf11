#include "core/base/hash.h"

#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <vector>

namespace spinaltap {
namespace {

std::string hash_of(const std::vector<unsigned char>& bytes) {
  WordHash64 hash;
  hash.add(bytes.data(), bytes.size());
  return hash.hex();
}

TEST(WordHash64, StartsAtItsPublishedOffsetAndPrintsSixteenDigits) {
  EXPECT_EQ(WordHash64().hex(), "cbf29ce484222325");
  EXPECT_EQ(WordHash64().value(), 0xcbf29ce484222325ULL);
}

TEST(WordHash64, ChangesWithEveryBit) {
  std::vector<unsigned char> bytes(37, 0x5a);
  std::set<std::string> seen{hash_of(bytes)};
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<unsigned char>(1U << (bit % 8));
    EXPECT_TRUE(seen.insert(hash_of(bytes)).second) << bit;
    bytes[bit / 8] ^= static_cast<unsigned char>(1U << (bit % 8));
  }
}

TEST(WordHash64, ChangesWithTheOrderOfWords) {
  std::vector<unsigned char> forth(16, 0), back(16, 0);
  forth[0] = back[8] = 1;
  EXPECT_NE(hash_of(forth), hash_of(back));
}

TEST(WordHash64, OfTwoAtOnceIsThatOfEach) {
  std::vector<unsigned char> bytes(37);
  for (std::size_t n = 0; n < bytes.size(); ++n) bytes[n] = static_cast<unsigned char>(7 * n);
  WordHash64 first, second, alone;
  first.add("begun ..", 8);
  alone.add("begun ..", 8);
  WordHash64::add_to_both(first, second, bytes.data(), bytes.size());
  alone.add(bytes.data(), bytes.size());
  EXPECT_EQ(first.value(), alone.value());
  EXPECT_EQ(second.hex(), hash_of(bytes));
}

TEST(WordHash64, GoesOnWhereItStopped) {
  const char text[] = "sixteen bytes ...";
  WordHash64 whole, parts;
  whole.add(text, 16);
  parts.add(text, 8);  // whole words
  parts.add(text + 8, 8);
  EXPECT_EQ(whole.value(), parts.value());
}

}  // namespace
}  // namespace spinaltap
