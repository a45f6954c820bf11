#include "core/sound/breakthrough_listener.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/check_range.h"
#include "core/sound/detail/state_filter.h"

namespace spinaltap {

void check_listener(const ListenerOptions& options) {
  const auto check = [](double value, double lowest, double highest, const char* what) {
    check_range(value, lowest, highest, "hearing a breakthrough", what);
  };
  check(options.sample_rate_hz, 22050.0, 192000.0, "a sample rate (Hz)");
  check(options.lowest_hz, 20.0, 5000.0, "a lower limit (Hz)");
  check(options.highest_hz, options.lowest_hz, 0.45 * options.sample_rate_hz,
        "an upper limit above the lower one (Hz)");
  check(options.average_s, 1e-3, 1.0, "a time of averaging (s)");
  check(options.floor_level, 0.0, 1.0, "a floor");
  check(options.open_hz, options.lowest_hz, options.highest_hz, "a frequency without bone, between the limits (Hz),");
  check(options.dense_hz, options.open_hz, options.highest_hz, "a frequency of dense bone above that without (Hz)");
  check(options.memory_s, 0.0, 60.0, "a memory (s)");
  check(options.hold_s, 0.0, 1.0, "a hold (s)");
}

struct BreakthroughListener::State {
  explicit State(const ListenerOptions& given)
      : options(given), keep(std::exp(-1.0 / (given.average_s * given.sample_rate_hz))) {
    check_listener(options);
    for (StateFilter* filter : {&high_pass[0], &high_pass[1]}) {
      filter->tune(options.lowest_hz, std::numbers::sqrt2 / 2.0, options.sample_rate_hz);
    }
    low_pass.tune(options.highest_hz, std::numbers::sqrt2 / 2.0, options.sample_rate_hz);
  }

  /// Root of the second moment of the spectrum, by the mean squares of the signal and of its differences: a sine of
  /// frequency f has the ratio (2 sin(pi f / rate))².
  double tone_hz() const {
    if (!(power > kSilence)) return 0.0;
    const double half = std::min(1.0, 0.5 * std::sqrt(difference_power / power));
    return std::asin(half) * options.sample_rate_hz / std::numbers::pi;
  }

  void hear(double sample) {
    const double band = low_pass.pass(high_pass[1].pass(high_pass[0].pass(sample).high).high).low;
    const double difference = band - last;
    last = band;
    power = band * band + keep * (power - band * band);
    difference_power = difference * difference + keep * (difference_power - difference * difference);
    ++count;
    const double hz = tone_hz();
    const double step_s = 1.0 / options.sample_rate_hz;
    const double now_s = static_cast<double>(count) * step_s;
    const bool cuts = power > options.floor_level * options.floor_level;
    dense_s = cuts && hz > options.dense_hz ? dense_s + step_s : 0.0;
    open_s = hz < options.open_hz ? open_s + step_s : 0.0;
    if (dense_s > options.hold_s) last_dense_s = now_s;
    if (open_s > options.hold_s && now_s - last_dense_s < options.memory_s) {
      heard.push_back({now_s, hz});
      last_dense_s = -std::numeric_limits<double>::infinity();
    }
  }

  /// Mean square below which there is nothing to hear: -120 dB.
  static constexpr double kSilence = 1e-12;
  ListenerOptions options;
  double keep;
  StateFilter high_pass[2], low_pass;
  double last = 0.0, power = 0.0, difference_power = 0.0;
  double dense_s = 0.0, open_s = 0.0;  ///< for how long it has been so
  double last_dense_s = -std::numeric_limits<double>::infinity();
  std::uint64_t count = 0;
  std::vector<HeardBreakthrough> heard;
};

BreakthroughListener::BreakthroughListener(const ListenerOptions& options) : state_(std::make_unique<State>(options)) {}
BreakthroughListener::~BreakthroughListener() = default;
BreakthroughListener::BreakthroughListener(BreakthroughListener&&) noexcept = default;

void BreakthroughListener::hear(std::span<const float> samples) {
  for (const float sample : samples) {
    check_range(static_cast<double>(sample), -1.0, 1.0, "hearing a breakthrough", "a sample");
    state_->hear(static_cast<double>(sample));
  }
}

std::span<const HeardBreakthrough> BreakthroughListener::heard() const noexcept { return state_->heard; }
double BreakthroughListener::tone_hz() const noexcept { return state_->tone_hz(); }
double BreakthroughListener::level() const noexcept { return std::sqrt(state_->power); }

}  // namespace spinaltap
