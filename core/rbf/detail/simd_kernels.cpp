#include "core/rbf/detail/simd_kernels.h"

#include "core/base/instruction_set.h"
#include "core/rbf/detail/lagrange_grid.h"

namespace spinaltap::detail {
namespace {

#define SPINALTAP_VECTOR_BYTES 16
namespace portable {
#include "core/rbf/detail/simd_kernels.inl"
}
#undef SPINALTAP_VECTOR_BYTES

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define SPINALTAP_X86_KERNELS
#pragma GCC push_options
#pragma GCC target("avx2")
#define SPINALTAP_VECTOR_BYTES 32
namespace avx2 {
#include "core/rbf/detail/simd_kernels.inl"
}
#undef SPINALTAP_VECTOR_BYTES
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx512f")
#define SPINALTAP_VECTOR_BYTES 64
namespace avx512 {
#include "core/rbf/detail/simd_kernels.inl"
}
#undef SPINALTAP_VECTOR_BYTES
#pragma GCC pop_options
#endif

}  // namespace

const std::vector<SimdKernels>& simd_kernels() {
  static const std::vector<SimdKernels> all = [] {
    std::vector<SimdKernels> found{{"portable", portable::near_sum, portable::interpolate,
                                    portable::interpolate_lattice, portable::multiply_spectra,
                                    portable::multiply_complex, portable::local_functions}};
#ifdef SPINALTAP_X86_KERNELS
    if (instruction_set() >= InstructionSet::avx2) {
      found.push_back({"avx2", avx2::near_sum, avx2::interpolate, avx2::interpolate_lattice, avx2::multiply_spectra,
                       avx2::multiply_complex, avx2::local_functions});
    }
    if (instruction_set() >= InstructionSet::avx512) {
      found.push_back({"avx512", avx512::near_sum, avx512::interpolate, avx512::interpolate_lattice,
                       avx512::multiply_spectra, avx512::multiply_complex, avx512::local_functions});
    }
#endif
    return found;
  }();
  return all;
}

const SimdKernels& best_simd_kernels() { return simd_kernels().back(); }

}  // namespace spinaltap::detail
