#include "core/session/real_time/detail/latest_value.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

namespace spinaltap {
namespace {

TEST(LatestValue, HasNothingNewBeforeTheFirstValue) {
  LatestValue<int> value;
  EXPECT_FALSE(value.refresh());
  EXPECT_EQ(value.front(), 0);
}

TEST(LatestValue, GivesTheLastOfSeveralValuesOnce) {
  LatestValue<int> value;
  for (const int n : {1, 2, 3}) value.write(n);
  EXPECT_TRUE(value.refresh());
  EXPECT_EQ(value.front(), 3);
  EXPECT_FALSE(value.refresh());
  EXPECT_EQ(value.front(), 3);
}

TEST(LatestValue, KeepsWhatTheReaderHasWhileTheWriterGoesOn) {
  LatestValue<int> value;
  value.write(1);
  ASSERT_TRUE(value.refresh());
  const int& kept = value.front();
  for (int n = 2; n < 10; ++n) value.write(n);
  EXPECT_EQ(kept, 1);
}

/// Large enough that a copy takes many instructions; whole where all words are the same.
using Words = std::array<std::uint64_t, 64>;

TEST(LatestValue, ReaderBesideAWriterSeesWholeValuesThatOnlyRiseAndAtLastTheLast) {
  constexpr std::uint64_t kMinWritten = 2'000'000;
  constexpr std::uint64_t kMinRead = 20;
  LatestValue<Words> value;
  std::atomic<bool> reads{false};
  std::atomic<bool> has_read_enough{false};
  std::atomic<std::uint64_t> written{0};  // the last one, once there is one
  std::thread writer([&] {
    while (!reads) {  // both at once, or there is nothing to see
    }
    // However rarely a busy machine lets the reader run.
    std::uint64_t n = 0;
    while (n < kMinWritten || !has_read_enough) {
      value.back().fill(++n);
      value.publish();
    }
    value.back().fill(++n);
    written = n;
    value.publish();
  });
  reads = true;
  std::uint64_t last = 0;
  std::uint64_t fresh = 0;
  std::uint64_t torn = 0;
  std::uint64_t back = 0;
  while (written == 0 || last < written) {
    if (!value.refresh()) continue;
    if (++fresh == kMinRead) has_read_enough = true;
    const Words& words = value.front();
    torn += std::any_of(words.begin(), words.end(), [&](std::uint64_t word) { return word != words[0]; }) ? 1U : 0U;
    back += words[0] <= last ? 1U : 0U;
    last = words[0];
  }
  writer.join();
  EXPECT_EQ(torn, 0U);
  EXPECT_EQ(back, 0U);
  EXPECT_EQ(last, written);
  EXPECT_GT(fresh, 10U);  // the reader ran beside the writer, not after it
}

}  // namespace
}  // namespace spinaltap
