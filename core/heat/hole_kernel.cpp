#include "core/heat/hole_kernel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr std::size_t kKernelSpreads = 1536;
constexpr std::size_t kWaves = 4096;
// Before, no heat has come (e^-30); after, it is as if from a line.
constexpr double kFirstSpread = 1.0 / 120.0;  ///< in squares of the distance
constexpr double kLastSpread = 1e3;           ///< in squares of the larger of distance and radius

}  // namespace

HoleKernel::HoleKernel(double radius_mm, double distance_mm, double transfer_per_mm) {
  if (!(radius_mm > 0.0) || !(distance_mm > 0.0) || !std::isfinite(radius_mm) || !std::isfinite(distance_mm)) {
    fail("heat beside a hole: expected a radius and a distance above 0, found ", radius_mm, " and ", distance_mm,
         " mm");
  }
  if (!(transfer_per_mm >= 0.0) || !std::isfinite(transfer_per_mm)) {
    fail("heat beside a hole: expected a heat transfer of 0 or more, found ", transfer_per_mm, " per mm");
  }
  const double larger_mm = std::max(radius_mm, distance_mm);
  const double first_mm2 = kFirstSpread * distance_mm * distance_mm;
  last_spread_mm2_ = kLastSpread * larger_mm * larger_mm;
  low_log_ = std::log(first_mm2);
  const double log_step = (std::log(last_spread_mm2_) - low_log_) / static_cast<double>(kKernelSpreads - 1);
  per_log_ = 1.0 / log_step;

  // 1/2π of the integral over waves u of u e^(-u² spread) φ(r) φ(a), φ being the solution that fits the wall; at the
  // wall itself it is -2 / πa over the norm (Wronski). Waves are spaced by logarithm: du = u d(ln u).
  const double r = radius_mm + distance_mm;
  const double h = transfer_per_mm;
  const double low_wave = std::log(1e-4 / std::sqrt(last_spread_mm2_));
  const double high_wave = std::log(6.0 / std::sqrt(first_mm2));
  const double wave_step = (high_wave - low_wave) / static_cast<double>(kWaves - 1);
  std::vector<double> squares(kWaves), weights(kWaves);
  for (std::size_t n = 0; n < kWaves; ++n) {
    const double u = std::exp(low_wave + wave_step * static_cast<double>(n));
    const double at_wall = u * radius_mm;
    const double j = u * std::cyl_bessel_j(1.0, at_wall) + h * std::cyl_bessel_j(0.0, at_wall);
    const double y = u * std::cyl_neumann(1.0, at_wall) + h * std::cyl_neumann(0.0, at_wall);
    const double wave = std::cyl_bessel_j(0.0, u * r) * y - std::cyl_neumann(0.0, u * r) * j;
    const double wall = -2.0 / (std::numbers::pi * radius_mm);
    squares[n] = u * u;
    weights[n] = 0.5 / std::numbers::pi * u * u * wave_step * wave * wall / (j * j + y * y);
  }
  table_.resize(kKernelSpreads);
  for (std::size_t n = 0; n < kKernelSpreads; ++n) {
    const double spread = std::exp(low_log_ + log_step * static_cast<double>(n));
    double sum = 0.0;
    for (std::size_t wave = 0; wave < kWaves; ++wave) {
      const double power = squares[wave] * spread;
      if (power > 40.0) break;
      sum += weights[wave] * std::exp(-power);
    }
    table_[n] = std::max(sum, 0.0);
  }
}

double HoleKernel::at(double spread_mm2) const noexcept {
  if (!(spread_mm2 > 0.0)) return 0.0;
  const double place = (std::log(spread_mm2) - low_log_) * per_log_;
  if (!(place > 0.0)) return 0.0;
  const auto below = static_cast<std::size_t>(std::min(place, 1e9));
  // As from a line; with a wall that gives off, in truth by a little less.
  if (below + 1 >= table_.size()) return table_.back() * last_spread_mm2_ / spread_mm2;
  const double share = place - static_cast<double>(below);
  return table_[below] + share * (table_[below + 1] - table_[below]);
}

}  // namespace spinaltap
