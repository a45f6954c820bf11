#include "vdb/engine/detail/move_kernels.h"

#include "core/base/kernel_sets.h"

namespace spinaltap::detail {

const std::vector<MoveKernels>& move_kernels() {
  static const std::vector<MoveKernels> all = kernels_of_this_machine<MoveKernels>();
  return all;
}

}  // namespace spinaltap::detail
