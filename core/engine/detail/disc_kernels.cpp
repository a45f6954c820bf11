#include "core/engine/detail/disc_kernels.h"

#include <cstring>

#include "core/base/instruction_set.h"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define SPINALTAP_X86_KERNELS
#endif

namespace spinaltap::detail {
namespace {

#define SPINALTAP_VECTOR_BYTES 16
namespace portable {
#include "core/engine/detail/disc_kernels.inl"
}
#undef SPINALTAP_VECTOR_BYTES

#ifdef SPINALTAP_X86_KERNELS
#pragma GCC push_options
#pragma GCC target("avx2")
#define SPINALTAP_VECTOR_BYTES 32
namespace avx2 {
#include "core/engine/detail/disc_kernels.inl"
}
#undef SPINALTAP_VECTOR_BYTES
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx512f,avx512bw,avx512vl,avx512dq")
#define SPINALTAP_VECTOR_BYTES 64
namespace avx512 {
#include "core/engine/detail/disc_kernels.inl"
}
#undef SPINALTAP_VECTOR_BYTES
#pragma GCC pop_options
#endif

}  // namespace

const std::vector<DiscKernels>& disc_kernels() {
  static const std::vector<DiscKernels> all = [] {
    std::vector<DiscKernels> found{{"portable", portable::check, portable::gap_squares}};
#ifdef SPINALTAP_X86_KERNELS
    const InstructionSet set = instruction_set();
    if (set >= InstructionSet::avx2) found.push_back({"AVX2", avx2::check, avx2::gap_squares});
    if (set >= InstructionSet::avx512) found.push_back({"AVX-512", avx512::check, avx512::gap_squares});
#endif
    return found;
  }();
  return all;
}

}  // namespace spinaltap::detail
