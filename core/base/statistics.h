#pragma once

#include <cstddef>
#include <span>

#include "core/base/geometry.h"

namespace spinaltap {

/// Wilson's score interval for a probability that was met `successes` times in `trials` independent trials (Wilson,
/// "Probable inference, the law of succession, and statistical inference", J. Am. Stat. Assoc. 1927). Stays within 0
/// and 1, and is right for rare events too, unlike the textbook's normal approximation. `confidence`: for example
/// 0.95. Without trials: 0 to 1. Throws Error on more successes than trials, and on a confidence not between 0 and 1.
Interval wilson_interval(std::size_t successes, std::size_t trials, double confidence = 0.95);

/// The standard normal distribution's quantile, right to about 1e-15 of itself: algorithm AS 241, PPND16 (Wichura,
/// "The percentage points of the normal distribution", Appl. Stat. 1988). Throws Error where `probability` is not
/// between 0 and 1, ends left out.
double normal_quantile(double probability);

/// Student's t distribution's quantile of whole `degrees` of freedom, right to about 1e-12 of itself: bisection of the
/// finite sums for its probability (Abramowitz & Stegun, 26.7.3 and 26.7.4). Throws Error where `probability` is not
/// between 0 and 1, ends left out, and on degrees that are not from 1 to 1000.
double student_quantile(double probability, int degrees);

/// Quantile of a sample: linear between the order statistics, the lowest at 0 and the highest at 1 (type 7 of Hyndman &
/// Fan 1996; what numpy and pandas do). Not a number without values. Throws Error where `share` is not within 0 and 1.
/// `ascending`: the sample, sorted.
double quantile(std::span<const double> ascending, double share);

}  // namespace spinaltap
