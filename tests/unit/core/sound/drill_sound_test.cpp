#include "core/sound/drill_sound.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/error.h"
#include "tests/support/nan.h"
#include "tests/support/spectrum.h"

namespace spinaltap {
namespace {

constexpr DrillSoundInput kIdle{.rpm = 1250.0};
constexpr DrillSoundInput kInCortex{.rpm = 1250.0, .thrust_n = 60.0, .torque_n_mm = 30.0, .density_g_cm3 = 1.4};

std::vector<float> next_of(DrillSound& sound, double seconds) {
  std::vector<float> samples(static_cast<std::size_t>(std::llround(seconds * sound.options().sample_rate_hz)));
  sound.render(samples);
  return samples;
}

/// A second of it, when it has settled.
std::vector<float> settled(const DrillSoundInput& input, const DrillSoundOptions& options = {}) {
  DrillSound sound(options);
  sound.set(input);
  next_of(sound, 2.0);
  return next_of(sound, 1.0);
}

TEST(DrillSound, HasItsPeaksAtMultiplesOfItsTurningInAir) {
  for (const double rate_hz : {44100.0, 48000.0}) {
    DrillSoundOptions options;
    options.sample_rate_hz = rate_hz;
    const std::vector<float> samples = settled(kIdle, options);
    for (int k = 1; k <= 12; ++k) {
      const double hz = k * 1250.0 / 60.0;
      EXPECT_NEAR(test::peak_near(samples, hz, rate_hz, 6), hz, 1.0) << k << " at " << rate_hz;
    }
    // As loud as its options say, asked at the frequency itself; hiss is spread over 24,000 bins.
    const double first = test::amplitude_at(samples, 1250.0 / 60.0, rate_hz);
    EXPECT_NEAR(first, options.rotation_level, 1e-3 * options.rotation_level + options.air_level / 50.0);
  }
}

TEST(DrillSound, HasItsPeaksAtMultiplesOfItsEdgesPassingWhileItCuts) {
  for (const int edges : {2, 3, 8}) {
    DrillSoundOptions options;
    options.edges = edges;
    options.droop_per_n_mm = 0.0;
    const std::vector<float> samples = settled(kInCortex, options);
    for (int m = 1; m <= 10; ++m) {
      const double hz = m * edges * 1250.0 / 60.0;
      EXPECT_NEAR(test::peak_near(samples, hz, 48000.0, 6), hz, 1.0) << m << " of " << edges;
    }
  }
}

TEST(DrillSound, SlowsDownUnderTorqueAndComesBack) {
  DrillSound sound;
  sound.set(kIdle);
  next_of(sound, 2.0);
  EXPECT_NEAR(sound.turning_hz(), 1250.0 / 60.0, 1e-6);
  sound.set(kInCortex);
  next_of(sound, 2.0);
  EXPECT_NEAR(sound.turning_hz(), 1250.0 / 60.0 * (1.0 - 30.0 * 0.0003), 1e-6);
  sound.set(kIdle);
  next_of(sound, 2.0);
  EXPECT_NEAR(sound.turning_hz(), 1250.0 / 60.0, 1e-6);
}

TEST(DrillSound, FoldsNothingBackFromBeyondHalfTheRate) {
  // Edges pass at 10,600 Hz: the third multiple, 31,800, would be heard at 16,200, the fourth at 5,600, the fifth at
  // 5,000. The turning's twelve multiples end at 15,900.
  DrillSoundOptions options;
  options.chip_level = options.air_level = options.droop_per_n_mm = 0.0;
  options.edges = 8;
  options.reference_rpm = 79500.0;
  const std::vector<float> samples = settled({.rpm = 79500.0, .thrust_n = 60.0}, options);
  EXPECT_GT(test::amplitude_at(samples, 10600.0, 48000.0), 0.9 * options.edge_level);
  EXPECT_GT(test::amplitude_at(samples, 1325.0, 48000.0), 0.9 * options.rotation_level);
  for (const double hz : {16200.0, 5600.0, 5000.0, 15600.0, 9800.0}) {
    EXPECT_LT(test::amplitude_at(samples, hz, 48000.0), 1e-6) << hz;
  }
  // A drill whose own turning is beyond half the rate is not heard at all.
  options.sample_rate_hz = 8000.0;
  options.reference_rpm = 300000.0;
  EXPECT_LT(test::rms(settled({.rpm = 300000.0, .thrust_n = 60.0}, options)), 1e-12);
}

TEST(DrillSound, IsTheSameBitForBitHoweverItIsCutAndBesideOthers) {
  const auto whole = [](std::size_t piece) {
    DrillSound sound;
    std::vector<float> samples(48000);
    std::span<float> left(samples);
    for (const DrillSoundInput& input : {kIdle, kInCortex, kIdle, DrillSoundInput{}}) {
      sound.set(input);
      std::span<float> now = left.first(12000);
      left = left.subspan(12000);
      while (!now.empty()) {
        const std::size_t count = std::min(piece, now.size());
        sound.render(now.first(count));
        now = now.subspan(count);
      }
    }
    return samples;
  };
  const std::vector<float> once = whole(12000);
  std::vector<std::vector<float>> others(8);
  tbb::parallel_for(0, 8,
                    [&](int n) { others[static_cast<std::size_t>(n)] = whole(static_cast<std::size_t>(1 + 61 * n)); });
  for (const std::vector<float>& other : others) EXPECT_TRUE(other == once);
  DrillSoundOptions other_seed;
  other_seed.seed = 2;
  DrillSound sound(other_seed);
  sound.set(kIdle);
  std::vector<float> samples(12000);
  sound.render(samples);
  EXPECT_FALSE(std::equal(samples.begin(), samples.end(), once.begin()));
}

TEST(DrillSound, GrowsWithThrustAndWithThePowerOfCutting) {
  DrillSoundOptions options;
  options.droop_per_n_mm = options.air_level = options.edge_share_of_chips = 0.0;
  const auto edge = [&](double thrust_n) {
    return test::amplitude_at(settled({.rpm = 1260.0, .thrust_n = thrust_n}, options), 42.0, 48000.0);
  };
  // The turning's own second multiple is at the edges' frequency too.
  const double turning = edge(0.0);
  EXPECT_NEAR(edge(60.0) - turning, options.edge_level, 1e-4);
  EXPECT_GT(edge(20.0), turning + 0.3 * options.edge_level);
  EXPECT_LT(edge(1e5), turning + 2.0 * options.edge_level);

  options.rotation_level = 0.0;
  const auto chips = [&](double torque_n_mm, double density_g_cm3) {
    return test::rms(settled({1250.0, 0.0, torque_n_mm, density_g_cm3}, options));
  };
  // 4 W at 1,250 rpm. A second of a band 1 kHz wide has some 2,000 independent values: 2 % of rms, twice over. The
  // trapezoidal rule narrows a band at f by the square of cos(pi f / rate).
  const double reference_n_mm = 4.0 / (2.0 * std::numbers::pi * 1250.0 / 60.0) * 1e3;
  for (const double density_g_cm3 : {0.0, 0.2, 1.4}) {
    const double centre_hz = std::max(1600.0, 6300.0 * std::pow(density_g_cm3 / 1.9, 0.28));
    const double level = options.chip_level * std::cos(std::numbers::pi * centre_hz / 48000.0);
    EXPECT_NEAR(chips(reference_n_mm, density_g_cm3), level, 0.04 * level) << density_g_cm3;
    // A ninth of the power: 2 (1/9) / (1 + 1/9) of it is heard.
    EXPECT_NEAR(chips(reference_n_mm / 9.0, density_g_cm3), level * std::sqrt(0.2), 0.04 * level) << density_g_cm3;
  }
  EXPECT_EQ(chips(0.0, 1.4), 0.0);
}

TEST(DrillSound, IsWithin1UnderAnyLoadAndTellsItsPeak) {
  DrillSoundOptions options;
  options.volume = 4.0;
  DrillSound sound(options);
  sound.set({500000.0, 1e5, 1e6, 10.0});
  float most = 0.0F;
  for (const DrillSoundInput& input :
       {DrillSoundInput{500000.0, 1e5, 1e6, 10.0}, DrillSoundInput{1250.0, 1e5, 3000.0, 1.4}, kInCortex}) {
    sound.set(input);
    for (const float sample : next_of(sound, 1.0)) {
      ASSERT_TRUE(std::isfinite(sample));
      most = std::max(most, std::abs(sample));
    }
  }
  EXPECT_LE(most, 1.0F);
  EXPECT_EQ(static_cast<float>(sound.peak()), most);
  EXPECT_GT(sound.bent(), 0U);
  // By its defaults nothing is bent in a vertebra's cortex.
  DrillSound usual;
  usual.set(kInCortex);
  next_of(usual, 5.0);
  EXPECT_EQ(usual.bent(), 0U);
}

TEST(DrillSound, ClicksNowhere) {
  // Without noise a click is a step from sample to sample that the loudest steady sound does not have.
  DrillSoundOptions options;
  options.chip_level = options.air_level = 0.0;
  const auto largest_step = [](const std::vector<float>& samples) {
    float largest = 0.0F;
    for (std::size_t n = 1; n < samples.size(); ++n) largest = std::max(largest, std::abs(samples[n] - samples[n - 1]));
    return largest;
  };
  const float steady = largest_step(settled({.rpm = 1250.0, .thrust_n = 60.0}, options));
  DrillSound sound(options);
  std::vector<float> all;
  for (int n = 0; n < 40; ++n) {
    sound.set({.rpm = n % 8 < 6 ? 1250.0 : 0.0, .thrust_n = n % 2 == 0 ? 60.0 : 0.0});
    const std::vector<float> some = next_of(sound, 0.0317);
    all.insert(all.end(), some.begin(), some.end());
  }
  EXPECT_LE(largest_step(all), 1.02F * steady);
  // A speed that takes multiples over half the rate and back.
  options.sample_rate_hz = 8000.0;
  DrillSound fast(options);
  all.clear();
  for (int n = 0; n < 8; ++n) {
    fast.set({.rpm = n % 2 == 0 ? 30000.0 : 15000.0});
    const std::vector<float> some = next_of(fast, 0.5);
    all.insert(all.end(), some.begin(), some.end());
  }
  // Its steepest: each of twelve multiples at twice its frequency, or at the rate's limit, in step.
  EXPECT_LE(largest_step(all), 2.0F * 2.0F * 3.11F * 0.03F);
}

TEST(DrillSound, RunsDownWhenItIsSwitchedOffAndIsSilentWhilePressed) {
  DrillSound sound;
  sound.set(kInCortex);
  next_of(sound, 1.0);
  sound.set({.rpm = 0.0, .thrust_n = 60.0, .torque_n_mm = 30.0, .density_g_cm3 = 1.4});
  const double first = test::rms(next_of(sound, 0.05));
  const double second = test::rms(next_of(sound, 0.3));
  EXPECT_GT(first, 0.01);
  EXPECT_LT(second, first);
  next_of(sound, 3.0);
  EXPECT_EQ(test::rms(next_of(sound, 0.1)), 0.0);
}

TEST(DrillSound, RejectsWhatIsNoNumberOrAbsurdAndGoesOnAsBefore) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  DrillSound sound, other;
  sound.set(kInCortex);
  other.set(kInCortex);
  for (const double bad : {test::kNan, kInf, -kInf, 1e9, -1e9}) {
    EXPECT_THROW(sound.set({.rpm = bad}), Error);
    EXPECT_THROW(sound.set({.rpm = 100.0, .thrust_n = bad}), Error);
    EXPECT_THROW(sound.set({.rpm = 100.0, .torque_n_mm = bad}), Error);
    EXPECT_THROW(sound.set({.rpm = 100.0, .density_g_cm3 = bad}), Error);
  }
  EXPECT_TRUE(next_of(sound, 0.1) == next_of(other, 0.1));
  const auto rejected = [](const auto& change) {
    DrillSoundOptions options;
    change(options);
    EXPECT_THROW(DrillSound{options}, Error);
  };
  for (const double bad : {test::kNan, kInf, -1.0, 1e7}) {
    rejected([&](DrillSoundOptions& o) { o.sample_rate_hz = bad; });
    rejected([&](DrillSoundOptions& o) { o.volume = bad; });
    rejected([&](DrillSoundOptions& o) { o.chip_level = bad; });
    rejected([&](DrillSoundOptions& o) { o.ramp_s = bad; });
    rejected([&](DrillSoundOptions& o) { o.chip_quality = bad; });
    rejected([&](DrillSoundOptions& o) { o.dense_g_cm3 = bad; });
    rejected([&](DrillSoundOptions& o) { o.chip_dense_hz = bad; });
  }
  rejected([](DrillSoundOptions& o) { o.edges = 0; });
  rejected([](DrillSoundOptions& o) { o.edges = 65; });
}

}  // namespace
}  // namespace spinaltap
