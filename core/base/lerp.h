#pragma once

#include <algorithm>

namespace spinaltap {

/// The value at `share` of the way between two, as std::lerp gives it: exact at 0 and 1, monotonic, never beyond the
/// ends for a share within them. Always inlined: where the compiler does not inline std::lerp, it is a weak function,
/// and a user's program that was compiled for fused multiply-add would replace its bits.
[[gnu::always_inline]] inline double lerp(double from, double to, double share) {
  if ((from <= 0 && to >= 0) || (from >= 0 && to <= 0)) return share * to + (1 - share) * from;
  if (share == 1) return to;
  const double between = from + share * (to - from);
  return (share > 1) == (to > from) ? std::max(to, between) : std::min(to, between);
}

}  // namespace spinaltap
