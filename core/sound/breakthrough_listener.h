#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace spinaltap {

/// When a sound says that the drill is through. docs/sound.md tells on which phantoms the values were set.
struct ListenerOptions {
  double sample_rate_hz = 48000.0;
  double lowest_hz = 1200.0;   ///< what is lower is the drill's own turning
  double highest_hz = 9000.0;  ///< what is higher is hiss
  double average_s = 0.012;    ///< time constant of the averages
  double floor_level = 0.006;  ///< rms below which nothing is cut: what is heard is the drill's own hiss
  double dense_hz = 4800.0;    ///< mean frequency above which bone is dense
  double open_hz = 3200.0;     ///< and below which there is none ahead
  double memory_s = 0.8;       ///< dense bone was no longer ago
  double hold_s = 0.008;       ///< that a frequency lasts
};
/// Rejects values that are not finite or make no sense.
void check_listener(const ListenerOptions& options);

struct HeardBreakthrough {
  double time_s = 0.0;   ///< of the sample at which it was known, from the first one
  double tone_hz = 0.0;  ///< mean frequency then
};

/// Hears in a drill's sound, and in nothing else, that it leaves dense bone for none: the mean frequency of what lies
/// between two limits falls from above one to below another within a short time. Causal: a sample never changes what
/// was told before it. The same samples give the same, in however many pieces they come.
class BreakthroughListener {
 public:
  /// Throws Error as check_listener() does.
  explicit BreakthroughListener(const ListenerOptions& options = {});
  ~BreakthroughListener();
  BreakthroughListener(BreakthroughListener&&) noexcept;

  /// The next samples. Throws Error on one that is no number or beyond -1 to 1; those before it were heard.
  void hear(std::span<const float> samples);
  /// In order.
  std::span<const HeardBreakthrough> heard() const noexcept;
  double tone_hz() const noexcept;  ///< mean frequency now; 0 where nothing was heard
  double level() const noexcept;    ///< rms of what lies between the limits

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace spinaltap
