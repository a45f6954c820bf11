#pragma once

#include <cmath>
#include <numbers>

namespace spinaltap {

/// A filter of two poles whose corner may move from sample to sample without a click: the state variable filter by the
/// trapezoidal rule (Zavalishin, The Art of VA Filter Design, 2012).
class StateFilter {
 public:
  struct Outputs {
    double low = 0.0, band = 0.0, high = 0.0;  ///< band: 1 at the corner
  };

  /// `corner_hz` below half the rate; bandwidth is the corner over `quality`.
  void tune(double corner_hz, double quality, double sample_rate_hz) noexcept {
    const double g = std::tan(std::numbers::pi * corner_hz / sample_rate_hz);
    damping_ = 1.0 / quality;
    a1_ = 1.0 / (1.0 + g * (g + damping_));
    a2_ = g * a1_;
    a3_ = g * a2_;
  }
  Outputs pass(double sample) noexcept {
    const double rest = sample - second_;
    const double band = a1_ * first_ + a2_ * rest;
    const double low = second_ + a2_ * first_ + a3_ * rest;
    first_ = 2.0 * band - first_;
    second_ = 2.0 * low - second_;
    return {low, damping_ * band, sample - damping_ * band - low};
  }

 private:
  double a1_ = 0.0, a2_ = 0.0, a3_ = 0.0, damping_ = 1.0;
  double first_ = 0.0, second_ = 0.0;
};

}  // namespace spinaltap
