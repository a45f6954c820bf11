#include "vdb/engine/detail/word_kernels.h"

#include <bit>
#include <cmath>

#include "core/base/instruction_set.h"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define SPINALTAP_X86_KERNELS
// GCC 12's header passes a register on purpose that nothing has written.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <immintrin.h>
#endif

namespace spinaltap::detail {
namespace {

#define SPINALTAP_VECTOR_BYTES 16
namespace portable {
#include "vdb/engine/detail/word_kernels.inl"
}
#undef SPINALTAP_VECTOR_BYTES

#ifdef SPINALTAP_X86_KERNELS
#pragma GCC push_options
#pragma GCC target("avx2")
#define SPINALTAP_VECTOR_BYTES 32
namespace avx2 {
#include "vdb/engine/detail/word_kernels.inl"
}
#undef SPINALTAP_VECTOR_BYTES
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx512f,avx512bw,avx512vl,avx512dq")
#define SPINALTAP_VECTOR_BYTES 64
namespace avx512 {
#include "vdb/engine/detail/word_kernels.inl"
}
#undef SPINALTAP_VECTOR_BYTES
#pragma GCC pop_options
#endif

}  // namespace

const std::vector<WordKernels>& word_kernels() {
  static const std::vector<WordKernels> all = [] {
    std::vector<WordKernels> found{{"portable", portable::look}};
#ifdef SPINALTAP_X86_KERNELS
    const InstructionSet set = instruction_set();
    if (set >= InstructionSet::avx2) found.push_back({"AVX2", avx2::look});
    if (set >= InstructionSet::avx512) found.push_back({"AVX-512", avx512::look});
#endif
    return found;
  }();
  return all;
}

}  // namespace spinaltap::detail
