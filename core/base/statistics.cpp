#include "core/base/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/base/lerp.h"

namespace spinaltap {
namespace {

using Coefficients = std::array<double, 8>;

// Wichura's: numerators and denominators for |p - 1/2| <= 0.425, and for the tails near and far.
constexpr Coefficients kMiddleOver{3.3871328727963666080e0,  1.3314166789178437745e+2, 1.9715909503065514427e+3,
                                   1.3731693765509461125e+4, 4.5921953931549871457e+4, 6.7265770927008700853e+4,
                                   3.3430575583588128105e+4, 2.5090809287301226727e+3};
constexpr Coefficients kMiddleUnder{1.0,
                                    4.2313330701600911252e+1,
                                    6.8718700749205790830e+2,
                                    5.3941960214247511077e+3,
                                    2.1213794301586595867e+4,
                                    3.9307895800092710610e+4,
                                    2.8729085735721942674e+4,
                                    5.2264952788528545610e+3};
constexpr Coefficients kNearOver{1.42343711074968357734e0,  4.63033784615654529590e0, 5.76949722146069140550e0,
                                 3.64784832476320460504e0,  1.27045825245236838258e0, 2.41780725177450611770e-1,
                                 2.27238449892691845833e-2, 7.74545014278341407640e-4};
constexpr Coefficients kNearUnder{1.0,
                                  2.05319162663775882187e0,
                                  1.67638483018380384940e0,
                                  6.89767334985100004550e-1,
                                  1.48103976427480074590e-1,
                                  1.51986665636164571966e-2,
                                  5.47593808499534494600e-4,
                                  1.05075007164441684324e-9};
constexpr Coefficients kFarOver{6.65790464350110377720e0,  5.46378491116411436990e0,  1.78482653991729133580e0,
                                2.96560571828504891230e-1, 2.65321895265761230930e-2, 1.24266094738807843860e-3,
                                2.71155556874348757815e-5, 2.01033439929228813265e-7};
constexpr Coefficients kFarUnder{1.0,
                                 5.99832206555887937690e-1,
                                 1.36929880922735805310e-1,
                                 1.48753612908506148525e-2,
                                 7.86869131145613259100e-4,
                                 1.84631831751005468180e-5,
                                 1.42151175831644588870e-7,
                                 2.04426310338993978564e-15};

double polynomial(const Coefficients& coefficients, double x) {
  double sum = 0.0;
  for (std::size_t n = coefficients.size(); n-- > 0;) sum = sum * x + coefficients[n];
  return sum;
}

double ratio(const Coefficients& over, const Coefficients& under, double x) {
  return polynomial(over, x) / polynomial(under, x);
}

/// Of lying within -t and t.
double student_within(double t, int degrees) {
  const double angle = std::atan(t / std::sqrt(static_cast<double>(degrees)));
  const double sine = std::sin(angle), cosine = std::cos(angle);
  const bool is_odd = degrees % 2 == 1;
  double term = is_odd ? cosine : 1.0;
  double sum = degrees == 1 ? 0.0 : term;
  for (int k = is_odd ? 3 : 2; k < degrees; k += 2) {
    term *= (k - 1.0) / k * cosine * cosine;
    sum += term;
  }
  return is_odd ? 2.0 / std::numbers::pi * (angle + sine * sum) : sine * sum;
}

}  // namespace

double student_quantile(double probability, int degrees) {
  if (!(probability > 0.0) || !(probability < 1.0)) {
    fail("Student's quantile: expected a probability between 0 and 1, found ", probability);
  }
  if (degrees < 1 || degrees > 1000) fail("Student's quantile: expected 1 to 1000 degrees, found ", degrees);
  const double within = std::abs(2.0 * probability - 1.0);
  double low = 0.0, high = 1.0;
  while (student_within(high, degrees) < within && high < 1e15) high *= 2.0;
  for (int halving = 0; halving < 200 && low < high; ++halving) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (student_within(middle, degrees) < within ? low : high) = middle;
  }
  return probability < 0.5 ? -high : within == 0.0 ? 0.0 : high;
}

double normal_quantile(double probability) {
  if (!(probability > 0.0) || !(probability < 1.0)) {
    fail("normal quantile: expected a probability between 0 and 1, found ", probability);
  }
  const double q = probability - 0.5;
  if (std::abs(q) <= 0.425) return q * ratio(kMiddleOver, kMiddleUnder, 0.180625 - q * q);
  const double r = std::sqrt(-std::log(q < 0.0 ? probability : 1.0 - probability));
  const double size = r <= 5.0 ? ratio(kNearOver, kNearUnder, r - 1.6) : ratio(kFarOver, kFarUnder, r - 5.0);
  return q < 0.0 ? -size : size;
}

Interval wilson_interval(std::size_t successes, std::size_t trials, double confidence) {
  if (successes > trials) fail("Wilson interval: expected at most ", trials, " successes, found ", successes);
  if (!(confidence > 0.0) || !(confidence < 1.0)) {
    fail("Wilson interval: expected a confidence between 0 and 1, found ", confidence);
  }
  if (trials == 0) return {0.0, 1.0};
  const double n = static_cast<double>(trials);
  const double p = static_cast<double>(successes) / n;
  const double z = normal_quantile(0.5 + 0.5 * confidence);
  const double middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  // Rounding would leave 1e-18 where the formula has 0.
  return {successes == 0 ? 0.0 : std::max(0.0, middle - half),
          successes == trials ? 1.0 : std::min(1.0, middle + half)};
}

double quantile(std::span<const double> ascending, double share) {
  if (!(share >= 0.0) || !(share <= 1.0)) fail("quantile: expected a share within 0 and 1, found ", share);
  if (ascending.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double place = share * static_cast<double>(ascending.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, ascending.size() - 1);
  return lerp(ascending[below], ascending[above], place - static_cast<double>(below));
}

}  // namespace spinaltap
