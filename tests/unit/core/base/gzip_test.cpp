#include "core/base/gzip.h"

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/base/staged_output.h"
#include "tests/support/gunzip.h"
#include "tests/support/temporary_folder.h"

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
    const test::TemporaryFolder folder;
    write_whole_file(folder.path() / "bytes.gz", gzip(bytes));
    EXPECT_EQ(test::gunzip(folder.path() / "bytes.gz"), bytes) << count;
  }
}

TEST(Gzip, HoldsNoTime) {
  const std::string stream = gzip("bone");
  EXPECT_EQ(stream.substr(0, 2), "\x1f\x8b");
  EXPECT_EQ(stream.substr(4, 4), std::string(4, '\0'));  // RFC 1952: seconds since 1970, 0 for none
}

}  // namespace
}  // namespace spinaltap
