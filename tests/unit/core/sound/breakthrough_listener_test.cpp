#include "core/sound/breakthrough_listener.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr double kRateHz = 48000.0;

/// Adds a sine to the end, without a click.
void add_sine(std::vector<float>& samples, double hz, double amplitude, double seconds) {
  const auto count = static_cast<std::size_t>(seconds * kRateHz);
  for (std::size_t n = 0; n < count; ++n) {
    samples.push_back(
        static_cast<float>(amplitude * std::sin(2.0 * std::numbers::pi * hz / kRateHz * static_cast<double>(n))));
  }
}

std::vector<HeardBreakthrough> heard_in(const std::vector<float>& samples) {
  BreakthroughListener listener;
  listener.hear(samples);
  return {listener.heard().begin(), listener.heard().end()};
}

TEST(BreakthroughListener, TellsASinesFrequencyAndLevel) {
  for (const double hz : {1800.0, 3000.0, 5000.0, 7000.0}) {
    std::vector<float> samples;
    add_sine(samples, hz, 0.1, 0.5);
    BreakthroughListener listener;
    listener.hear(samples);
    // The average of 12 ms ripples at twice the frequency, by one part in 2 pi 2 f 12 ms.
    EXPECT_NEAR(listener.tone_hz(), hz, 0.01 * hz);
    EXPECT_NEAR(listener.level(), 0.1 / std::sqrt(2.0), 0.02) << hz;
  }
}

TEST(BreakthroughListener, HearsAFallFromDenseToOpenOnce) {
  std::vector<float> samples;
  add_sine(samples, 6000.0, 0.1, 0.5);
  add_sine(samples, 2000.0, 0.1, 0.5);
  const auto heard = heard_in(samples);
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_GT(heard[0].time_s, 0.5 + ListenerOptions{}.hold_s);
  EXPECT_LT(heard[0].time_s, 0.5 + 0.04);
}

TEST(BreakthroughListener, HearsNoneInWhatIsNone) {
  const auto none = [](double first_hz, double second_hz, double amplitude, double between_s = 0.0) {
    std::vector<float> samples;
    add_sine(samples, first_hz, amplitude, 0.5);
    add_sine(samples, 4000.0, amplitude, between_s);
    add_sine(samples, second_hz, amplitude, 0.5);
    return heard_in(samples).empty();
  };
  EXPECT_TRUE(none(6000.0, 4000.0, 0.1)) << "from dense to cancellous bone";
  EXPECT_TRUE(none(4000.0, 2000.0, 0.1)) << "out of cancellous bone";
  EXPECT_TRUE(none(2000.0, 6000.0, 0.1)) << "into dense bone";
  EXPECT_TRUE(none(6000.0, 2000.0, 0.004)) << "the drill's own hiss";
  EXPECT_TRUE(none(6000.0, 2000.0, 0.1, 1.5)) << "dense bone long ago";
  EXPECT_FALSE(none(6000.0, 2000.0, 0.1, 0.2)) << "dense bone not long ago";
  EXPECT_TRUE(heard_in(std::vector<float>(48000)).empty()) << "silence";
  EXPECT_TRUE(heard_in({}).empty());
}

TEST(BreakthroughListener, IsCausalAndTheSameInPieces) {
  std::vector<float> samples;
  for (int n = 0; n < 3; ++n) {
    add_sine(samples, 6000.0, 0.1, 0.3);
    add_sine(samples, 2000.0, 0.1, 0.3);
  }
  const auto all = heard_in(samples);
  ASSERT_EQ(all.size(), 3U);
  BreakthroughListener listener;
  for (std::size_t n = 0; n < samples.size(); n += 100) {
    listener.hear(std::span(samples).subspan(n, 100));
    const double now_s = static_cast<double>(n + 100) / kRateHz;
    // What is known by now is what was known by then in the whole.
    std::size_t known = 0;
    while (known < all.size() && all[known].time_s <= now_s) ++known;
    ASSERT_EQ(listener.heard().size(), known);
  }
  for (std::size_t n = 0; n < all.size(); ++n) EXPECT_EQ(listener.heard()[n].time_s, all[n].time_s);
}

TEST(BreakthroughListener, RejectsWhatIsNoSoundAndOptionsThatMakeNoSense) {
  BreakthroughListener listener;
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1.1F}) {
    EXPECT_THROW(listener.hear({&bad, 1}), Error);
  }
  const auto rejected = [](const auto& change) {
    ListenerOptions options;
    change(options);
    EXPECT_THROW(BreakthroughListener{options}, Error);
  };
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1.0}) {
    rejected([&](ListenerOptions& o) { o.sample_rate_hz = bad; });
    rejected([&](ListenerOptions& o) { o.lowest_hz = bad; });
    rejected([&](ListenerOptions& o) { o.highest_hz = bad; });
    rejected([&](ListenerOptions& o) { o.average_s = bad; });
    rejected([&](ListenerOptions& o) { o.floor_level = bad; });
    rejected([&](ListenerOptions& o) { o.dense_hz = bad; });
    rejected([&](ListenerOptions& o) { o.open_hz = bad; });
    rejected([&](ListenerOptions& o) { o.memory_s = bad; });
    rejected([&](ListenerOptions& o) { o.hold_s = bad; });
  }
  rejected([](ListenerOptions& o) { o.open_hz = o.dense_hz + 1.0; });
  rejected([](ListenerOptions& o) { o.sample_rate_hz = 8000.0; });
}

}  // namespace
}  // namespace spinaltap
