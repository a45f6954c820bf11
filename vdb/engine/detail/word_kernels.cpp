#include "vdb/engine/detail/word_kernels.h"

#include "core/base/kernel_sets.h"

namespace spinaltap::detail {

const std::vector<WordKernels>& word_kernels() {
  static const std::vector<WordKernels> all = kernels_of_this_machine<WordKernels>();
  return all;
}

}  // namespace spinaltap::detail
