#include "core/points/occupied_bits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/unit/core/engine/askew_block.h"

namespace spinaltap {
namespace {

constexpr std::uint64_t kOccupancySeed = 64;
constexpr std::size_t kBits = 64 * 5;

std::vector<std::uint64_t> random_words(test::Draw& draw) {
  std::vector<std::uint64_t> words(kBits / 64);
  for (std::uint64_t& word : words) {
    word = draw.bits();
    const double kind = draw(0.0, 1.0);
    if (kind < 0.2) word = 0;
    if (kind > 0.8) word = ~std::uint64_t{0};
    if (kind > 0.4 && kind < 0.6) word &= draw.bits() & draw.bits() & draw.bits();  // few
  }
  return words;
}

std::vector<std::size_t> by_plain_loop(const std::vector<std::uint64_t>& words, std::size_t begin, std::size_t end) {
  std::vector<std::size_t> set;
  for (std::size_t i = begin; i < end; ++i) {
    if ((words[i / 64] >> (i % 64) & 1) != 0) set.push_back(i);
  }
  return set;
}

/// Ranges of all kinds: any, empty, reversed, of whole words, up to the very end.
std::pair<std::size_t, std::size_t> random_range(test::Draw& draw) {
  const std::size_t a = draw.bits() % (kBits + 1);
  const std::size_t b = draw.bits() % (kBits + 1);
  if (draw(0.0, 1.0) < 0.2) return {a / 64 * 64, b / 64 * 64};
  if (draw(0.0, 1.0) < 0.1) return {a, kBits};
  return {a, b};
}

TEST(OccupiedBits, AreVisitedAsAPlainLoopWouldBothWays) {
  SCOPED_TRACE(::testing::Message() << "seed " << kOccupancySeed);
  test::Draw draw(kOccupancySeed);
  for (int n = 0; n < 20'000; ++n) {
    const std::vector<std::uint64_t> words = random_words(draw);
    const auto [begin, end] = random_range(draw);
    std::vector<std::size_t> expected = by_plain_loop(words, begin, end);
    std::vector<std::size_t> seen;
    const auto note = [&](std::size_t index) {
      seen.push_back(index);
      return true;
    };
    EXPECT_TRUE(visit_up(words.data(), begin, end, note));
    ASSERT_EQ(seen, expected) << begin << " to " << end;
    seen.clear();
    EXPECT_TRUE(visit_down(words.data(), begin, end, note));
    std::ranges::reverse(expected);
    ASSERT_EQ(seen, expected) << begin << " to " << end;
  }
}

TEST(OccupiedBits, EndTheVisitWhenToldTo) {
  SCOPED_TRACE(::testing::Message() << "seed " << kOccupancySeed);
  test::Draw draw(kOccupancySeed + 1);
  for (int n = 0; n < 5'000; ++n) {
    const std::vector<std::uint64_t> words = random_words(draw);
    const auto [begin, end] = random_range(draw);
    const std::size_t count = by_plain_loop(words, begin, end).size();
    const std::size_t max = 1 + draw.bits() % 100;
    std::size_t up = 0;
    std::size_t down = 0;
    EXPECT_EQ(visit_up(words.data(), begin, end, [&](std::size_t) { return ++up < max; }), count < max);
    EXPECT_EQ(visit_down(words.data(), begin, end, [&](std::size_t) { return ++down < max; }), count < max);
    ASSERT_EQ(up, std::min(count, max));
    ASSERT_EQ(down, std::min(count, max));
  }
}

TEST(OccupiedBits, MayBeClearedWhileTheyAreVisited) {
  SCOPED_TRACE(::testing::Message() << "seed " << kOccupancySeed);
  test::Draw draw(kOccupancySeed + 2);
  for (int n = 0; n < 5'000; ++n) {
    std::vector<std::uint64_t> words = random_words(draw);
    const auto [begin, end] = random_range(draw);
    const std::vector<std::size_t> expected = by_plain_loop(words, begin, end);
    const std::size_t outside = by_plain_loop(words, 0, kBits).size() - expected.size();
    std::size_t seen = 0;
    const auto clear = [&](std::size_t index) {
      words[index / 64] &= ~(std::uint64_t{1} << (index % 64));
      ++seen;
      return true;
    };
    n % 2 == 0 ? visit_up(words.data(), begin, end, clear) : visit_down(words.data(), begin, end, clear);
    ASSERT_EQ(seen, expected.size());
    ASSERT_TRUE(by_plain_loop(words, begin, end).empty());
    ASSERT_EQ(by_plain_loop(words, 0, kBits).size(), outside);
  }
}

}  // namespace
}  // namespace spinaltap
