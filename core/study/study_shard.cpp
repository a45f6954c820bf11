#include "core/study/study_shard.h"

#include "core/base/error.h"

namespace spinaltap {

std::vector<std::size_t> runs_of_shard(std::size_t runs, const StudyShard& shard) {
  if (shard.index < 1 || shard.index > shard.count) {
    fail("expected a shard from 1 to ", shard.count, ", found ", shard.index);
  }
  std::vector<std::size_t> numbers;
  for (std::size_t n = shard.index - 1; n < runs; n += shard.count) numbers.push_back(n);
  return numbers;
}

}  // namespace spinaltap
