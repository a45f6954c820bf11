#include "core/base/random.h"

#include <cmath>
#include <numbers>

namespace spinaltap {

double random_normal(std::uint64_t seed, std::uint64_t index) {
  const double u = random_uniform(seed, 2 * index);
  const double v = random_uniform(seed, 2 * index + 1);
  // 1 - u lies in (0, 1], so the logarithm is finite.
  return std::sqrt(-2.0 * std::log(1.0 - u)) * std::cos(2.0 * std::numbers::pi * v);
}

}  // namespace spinaltap
