#pragma once

namespace spinaltap {

/// Vector instructions that inner loops are compiled for. All give the same bits.
enum class InstructionSet { portable, avx2, avx512 };

/// The widest set that this CPU has (AVX-512: F, BW, VL and DQ). The variable SPINALTAP_INSTRUCTIONS of the environment
/// (portable, avx2, avx512) asks for a narrower one, to compare results; read once.
InstructionSet instruction_set();

}  // namespace spinaltap
