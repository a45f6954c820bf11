#include "core/study/study_shard.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {
namespace {

TEST(StudyShard, AreAShareOfTheRunsEachAndTogetherAll) {
  for (const std::size_t runs : {0UL, 1UL, 7UL, 100UL}) {
    for (const std::size_t count : {1UL, 3UL, 8UL}) {
      std::vector<int> times(runs, 0);
      for (std::size_t index = 1; index <= count; ++index) {
        const std::vector<std::size_t> numbers = runs_of_shard(runs, {index, count});
        EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
        // None has more than another but for the one that does not divide.
        EXPECT_GE(numbers.size(), runs / count);
        EXPECT_LE(numbers.size(), runs / count + 1);
        for (const std::size_t n : numbers) ++times.at(n);
      }
      EXPECT_EQ(times, std::vector<int>(runs, 1));
    }
  }
  EXPECT_THROW(runs_of_shard(10, {0, 3}), Error);
  EXPECT_THROW(runs_of_shard(10, {4, 3}), Error);
}

}  // namespace
}  // namespace spinaltap
