#include "core/plan/convergence.h"

#include "core/base/lerp.h"

namespace spinaltap {

std::optional<ConvergenceRange> published_convergence(Level level) {
  constexpr double kLumbarStepDeg = 5.0, kAsideDeg = 10.0;
  const auto number_from = [level](Level first) { return static_cast<int>(level) - static_cast<int>(first); };
  const int lumbar = number_from(Level::kL1);
  if (lumbar >= 0 && level <= Level::kL5) {
    const double middle_deg = kLumbarStepDeg * (lumbar + 1);
    return ConvergenceRange{middle_deg - kAsideDeg, middle_deg + kAsideDeg};
  }
  if (level < Level::kT1 || level > Level::kT12) return std::nullopt;
  const double share = number_from(Level::kT1) / 11.0;
  return ConvergenceRange{lerp(23.4 - 6.4, -9.8 - 4.8, share), lerp(35.4 + 4.4, 4.0 + 4.4, share)};
}

}  // namespace spinaltap
