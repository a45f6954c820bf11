#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

namespace spinaltap::test {

/// Amplitude of a sine of `hz` in samples: Goertzel's recurrence under a Hann window, which lets nothing through that
/// is two bins (of the sample rate over their number) away and further but for a few millionths.
inline double amplitude_at(std::span<const float> samples, double hz, double sample_rate_hz) {
  const double turn = 2.0 * std::numbers::pi / static_cast<double>(samples.size());
  const double step = 2.0 * std::numbers::pi * hz / sample_rate_hz;
  const double factor = 2.0 * std::cos(step);
  double now = 0.0, before = 0.0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const double window = 1.0 - std::cos(turn * static_cast<double>(n));
    const double next = window * static_cast<double>(samples[n]) + factor * now - before;
    before = now;
    now = next;
  }
  const double power = now * now + before * before - factor * now * before;
  return 2.0 * std::sqrt(std::max(0.0, power)) / static_cast<double>(samples.size());
}

/// The bin with the largest amplitude within `reach` bins of a frequency, as a frequency.
inline double peak_near(std::span<const float> samples, double hz, double sample_rate_hz, int reach) {
  const double bin_hz = sample_rate_hz / static_cast<double>(samples.size());
  const double middle = std::round(hz / bin_hz);
  double best_hz = 0.0, best = -1.0;
  for (int bin = -reach; bin <= reach; ++bin) {
    const double at_hz = (middle + bin) * bin_hz;
    const double amplitude = amplitude_at(samples, at_hz, sample_rate_hz);
    if (amplitude > best) {
      best = amplitude;
      best_hz = at_hz;
    }
  }
  return best_hz;
}

inline double rms(std::span<const float> samples) {
  double sum = 0.0;
  for (const float sample : samples) sum += static_cast<double>(sample) * static_cast<double>(sample);
  return std::sqrt(sum / static_cast<double>(samples.size()));
}

}  // namespace spinaltap::test
