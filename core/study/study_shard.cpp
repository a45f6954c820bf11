#include "core/study/study_shard.h"

#include "core/base/error.h"

namespace spinaltap {

std::vector<std::size_t> runs_of_shard(std::size_t runs, const StudyShard& shard) {
  if (shard.index < 1 || shard.index > shard.count) {
    fail("expected a shard from 1 to ", shard.count, ", found ", shard.index);
  }
  std::vector<std::size_t> numbers;
  const std::size_t end = runs * shard.index / shard.count;
  for (std::size_t n = runs * (shard.index - 1) / shard.count; n < end; ++n) numbers.push_back(n);
  return numbers;
}

}  // namespace spinaltap
