#include "apps/report/plot_ticks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/report/text.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

/// 10^exponent, exact for the exponents whose power is (pow() need not be).
double power_of_ten(int exponent) {
  double power = 1.0;
  for (int i = 0; i < std::abs(exponent); ++i) power *= 10.0;
  return exponent < 0 ? 1.0 / power : power;
}

/// m * 10^exponent, rounded once.
double scaled(double m, int exponent) {
  return exponent < 0 ? m / power_of_ten(-exponent) : m * power_of_ten(exponent);
}

struct Step {
  double mantissa;  // 1, 2 or 5
  int exponent;
};

/// The smallest of 1, 2, 5 times a power of ten that is not below `value`.
Step step_above(double value) {
  const int exponent = static_cast<int>(std::floor(std::log10(value)));
  for (const double mantissa : {1.0, 2.0, 5.0}) {
    if (scaled(mantissa, exponent) >= value * (1.0 - 1e-9)) return {mantissa, exponent};
  }
  return {1.0, exponent + 1};
}

void check_range(double low, double high) {
  if (!std::isfinite(low) || !std::isfinite(high)) fail("plot: expected a finite range, found ", low, " to ", high);
}

}  // namespace

AxisTicks linear_ticks(double low, double high, int count) {
  check_range(low, high);
  if (high < low) std::swap(low, high);
  if (!(high - low > 1e-12 * std::max(std::abs(low), std::abs(high)))) {
    const double half = low == 0.0 ? 1.0 : 0.1 * std::abs(low);
    low -= half;
    high += half;
  }
  const Step step = step_above((high - low) / std::max(count, 1));
  const double step_value = scaled(step.mantissa, step.exponent);
  const double slack = 1e-9;
  const double first = std::floor(low / step_value + slack);
  const double last = std::ceil(high / step_value - slack);
  AxisTicks ticks;
  // From whole numbers, so that 0.3 is the double nearest 0.3.
  for (double n = first; n <= last; n += 1.0) ticks.major.push_back(scaled(n * step.mantissa, step.exponent));
  ticks.low = ticks.major.front();
  ticks.high = ticks.major.back();
  return ticks;
}

AxisTicks log_ticks(double low, double high) {
  check_range(low, high);
  if (high < low) std::swap(low, high);
  if (!(low > 0.0)) fail("plot: expected values above 0 on a logarithmic axis, found ", low);
  const auto round_values = [](int exponent) {
    return std::array<double, 3>{scaled(1.0, exponent), scaled(2.0, exponent), scaled(5.0, exponent)};
  };
  const int first = static_cast<int>(std::floor(std::log10(low))) - 1;
  const int last = static_cast<int>(std::ceil(std::log10(high))) + 1;
  AxisTicks ticks;
  ticks.low = scaled(1.0, first);
  ticks.high = scaled(1.0, last);
  for (int exponent = first; exponent <= last; ++exponent) {
    for (const double value : round_values(exponent)) {
      if (value <= low * (1.0 + 1e-9)) ticks.low = value;
    }
  }
  for (int exponent = last; exponent >= first; --exponent) {
    const auto values = round_values(exponent);
    for (auto value = values.rbegin(); value != values.rend(); ++value) {
      if (*value >= high * (1.0 - 1e-9) && *value > ticks.low) ticks.high = *value;
    }
  }
  const bool label_all = ticks.high / ticks.low < 1000.0;
  for (int exponent = first; exponent <= last; ++exponent) {
    for (int m = 1; m < 10; ++m) {
      const double value = scaled(m, exponent);
      if (value < ticks.low || value > ticks.high) continue;
      const bool labelled = m == 1 || (label_all && (m == 2 || m == 5));
      (labelled ? ticks.major : ticks.minor).push_back(value);
    }
  }
  return ticks;
}

std::string tick_label(double value, double step) {
  struct Unit {
    double from;
    const char* letter;
  };
  constexpr std::array<Unit, 3> kUnits{{{1e9, "G"}, {1e6, "M"}, {1e3, "k"}}};
  const double size = std::max(std::abs(value), 2.0 * step);
  if (size >= 1e4 && value != 0.0) {
    for (const Unit& unit : kUnits) {
      if (std::abs(value) >= unit.from) return svg_number(value / unit.from, 3) + "\u00A0" + unit.letter;
    }
  }
  if (size < 1e-4 && value != 0.0) {
    const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
    return svg_number(value / power_of_ten(exponent), 3) + "e" + std::to_string(exponent);
  }
  const double finest = step > 0.0 ? step : std::abs(value);
  const int decimals = finest > 0.0 ? std::max(0, static_cast<int>(std::ceil(-std::log10(finest) - 1e-9))) : 0;
  return svg_number(value, decimals);
}

}  // namespace spinaltap
