#include "core/rbf/detail/simd_kernels.h"

#include "core/base/kernel_sets.h"

namespace spinaltap::detail {

const std::vector<SimdKernels>& simd_kernels() {
  static const std::vector<SimdKernels> all = kernels_of_this_machine<SimdKernels>();
  return all;
}

const SimdKernels& best_simd_kernels() { return simd_kernels().back(); }

}  // namespace spinaltap::detail
