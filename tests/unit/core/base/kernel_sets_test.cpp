#include "core/base/kernel_sets.h"

#include <gtest/gtest.h>

namespace spinaltap {
namespace {

/// Kernels that say of which set they are.
struct NamedKernels {
  InstructionSet set;
  static NamedKernels portable() { return {InstructionSet::portable}; }
  static NamedKernels avx2() { return {InstructionSet::avx2}; }
  static NamedKernels avx512() { return {InstructionSet::avx512}; }
};

TEST(KernelSets, AreThoseUpToTheWidestOfThisMachinePortableFirst) {
  const auto found = kernels_of_this_machine<NamedKernels>();
  ASSERT_EQ(found.size(), 1U + static_cast<std::size_t>(instruction_set()));
  for (std::size_t n = 0; n < found.size(); ++n) EXPECT_EQ(found[n].set, static_cast<InstructionSet>(n));
}

// Other tests compare the sets that the machine has. This one says which it has not.
TEST(KernelSets, AreAllComparedHere) {
#if !defined(__x86_64__)
  GTEST_SKIP() << "no x86-64: portable kernels are the only ones";
#else
  const InstructionSet widest = instruction_set();
  if (widest == InstructionSet::portable) {
    GTEST_SKIP() << "neither AVX2 nor AVX-512 (CPU, or SPINALTAP_INSTRUCTIONS): portable kernels alone were tested";
  }
  if (widest == InstructionSet::avx2) {
    GTEST_SKIP() << "no AVX-512 (CPU, or SPINALTAP_INSTRUCTIONS): portable kernels and those for AVX2 were compared";
  }
  EXPECT_EQ(kernels_of_this_machine<NamedKernels>().size(), 3U);
#endif
}

}  // namespace
}  // namespace spinaltap
