#include "core/base/instruction_set.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace spinaltap {
namespace {

InstructionSet widest_of_cpu() {
#if defined(__x86_64__) && defined(__GNUC__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") == 0) return InstructionSet::portable;
  const bool has_avx512 = __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
                          __builtin_cpu_supports("avx512vl") != 0 && __builtin_cpu_supports("avx512dq") != 0;
  return has_avx512 ? InstructionSet::avx512 : InstructionSet::avx2;
#else
  return InstructionSet::portable;
#endif
}

InstructionSet widest_allowed() {
  const char* const text = std::getenv("SPINALTAP_INSTRUCTIONS");
  const std::string_view allowed = text == nullptr ? "" : text;
  return allowed == "portable" ? InstructionSet::portable
         : allowed == "avx2"   ? InstructionSet::avx2
                               : InstructionSet::avx512;
}

}  // namespace

InstructionSet instruction_set() {
  static const InstructionSet set = std::min(widest_of_cpu(), widest_allowed());
  return set;
}

}  // namespace spinaltap
