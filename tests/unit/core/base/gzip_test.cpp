#include "core/base/gzip.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

std::string mixed_bytes(std::size_t count) {
  std::string bytes(count, '\0');
  for (std::size_t i = 0; i < count; i += 3)
    bytes[i] = static_cast<char>(static_cast<int>(255.0 * random_uniform(3, i)));
  return bytes;
}

TEST(Gzip, ComesBackAsItWas) {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{1'000'000}}) {
    const std::string bytes = mixed_bytes(count);
    EXPECT_EQ(gunzip(gzip(bytes), count), bytes) << count;
  }
}

TEST(Gzip, HoldsNoTime) {
  const std::string stream = gzip("bone");
  EXPECT_EQ(stream.substr(0, 2), "\x1f\x8b");
  EXPECT_EQ(stream.substr(4, 4), std::string(4, '\0'));  // RFC 1952: seconds since 1970, 0 for none
}

TEST(Gzip, RejectsStreamsThatAreDamagedOrOfAnotherSize) {
  const std::string bytes = mixed_bytes(10'000);
  const std::string stream = gzip(bytes);
  EXPECT_THROW(gunzip(stream, 9'999), Error);
  EXPECT_THROW(gunzip(stream, 10'001), Error);
  EXPECT_THROW(gunzip(stream.substr(0, stream.size() / 2), 10'000), Error);
  EXPECT_THROW(gunzip("not gzip at all", 10), Error);
  std::string damaged = stream;
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 0x55);
  EXPECT_THROW(gunzip(damaged, 10'000), Error);
  EXPECT_THROW(gunzip("", 10), Error);
}

}  // namespace
}  // namespace spinaltap
