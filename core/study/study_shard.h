#pragma once

#include <cstddef>
#include <vector>

namespace spinaltap {

/// One of the shares that a study is cut into: neighbouring runs, so that it meets few bones.
struct StudyShard {
  std::size_t index = 1;
  std::size_t count = 1;
};

/// The numbers of a shard's runs, in order, of a study of `runs`. Throws Error where the index is not 1 to the count.
std::vector<std::size_t> runs_of_shard(std::size_t runs, const StudyShard& shard);

}  // namespace spinaltap
