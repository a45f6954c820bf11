#include "core/engine/detail/disc_kernels.h"

#include "core/base/kernel_sets.h"

namespace spinaltap::detail {

const std::vector<DiscKernels>& disc_kernels() {
  static const std::vector<DiscKernels> all = kernels_of_this_machine<DiscKernels>();
  return all;
}

}  // namespace spinaltap::detail
