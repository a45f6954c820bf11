#pragma once

#include <vector>

#include "core/base/instruction_set.h"

namespace spinaltap {

/// Kernels: inner loops that CMake's spinaltap_kernels() compiles once for each set of instructions, each time with
/// that set's own flags, from an .inl. It defines for its struct of pointers to them, with three macros of the set's:
///
///   DiscKernels DiscKernels::SPINALTAP_KERNEL_SET() { return {SPINALTAP_KERNEL_NAME, detail::check,
///   detail::gap_squares}; }
///
/// SPINALTAP_VECTOR_BYTES is the size of its registers. All else there lies in an unnamed namespace, and no function of
/// a header's is called, of the standard library's neither: of several copies of an inline function a linker keeps one,
/// for the whole program, and that one must not be the one for AVX-512. Sums and products are written out in one order
/// and never fused, so that all sets agree to the last bit.

/// The sets that this machine can run (see instruction_set()); portable ones first, the fastest last.
template <class Kernels>
std::vector<Kernels> kernels_of_this_machine() {
  std::vector<Kernels> found{Kernels::portable()};
#if defined(__x86_64__)
  // What is compiled for a set is called only where there is one, even if it but returns pointers.
  if (instruction_set() >= InstructionSet::avx2) found.push_back(Kernels::avx2());
  if (instruction_set() >= InstructionSet::avx512) found.push_back(Kernels::avx512());
#endif
  return found;
}

}  // namespace spinaltap
