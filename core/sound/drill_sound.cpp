#include "core/sound/drill_sound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/check_range.h"
#include "core/base/random.h"
#include "core/sound/detail/state_filter.h"

namespace spinaltap {
namespace {

constexpr int kRotationHarmonics = 12;
constexpr int kEdgeHarmonics = 20;
/// Harmonics fade out over this share of the sample rate below half of it, so that none comes or goes with a click.
constexpr double kFadeShare = 0.05;

double from_zero(double value, double highest, const char* what) {
  check_range(value, -highest, highest, "sound of a drill", what);
  return std::max(0.0, value);
}

/// 1 at 1, at most 2: twice as much is no longer twice as loud.
double saturated(double share) { return 2.0 * share / (1.0 + share); }

/// Goes to a target as a first-order lag does.
class Ramp {
 public:
  void set_time(double seconds, double sample_rate_hz) { keep_ = std::exp(-1.0 / (seconds * sample_rate_hz)); }
  void set_target(double target) { target_ = target; }
  double next() {
    value_ = target_ + keep_ * (value_ - target_);
    if (std::abs(value_ - target_) < 1e-12) value_ = target_;  // no denormal numbers, which are slow
    return value_;
  }
  void jump_to(double value) { value_ = target_ = value; }
  double value() const { return value_; }

 private:
  double keep_ = 0.0, target_ = 0.0, value_ = 0.0;
};

/// The sum over k = 1 ... `count` of cos(2 pi k `turns`) / k, without those above half the sample rate. Cosines of
/// multiples by Chebyshev's recurrence.
double harmonics(double turns, double base_hz, double sample_rate_hz, int count) {
  const double first = std::cos(2.0 * std::numbers::pi * turns);
  double before = 1.0, now = first, sum = 0.0;
  for (int k = 1; k <= count; ++k) {
    const double below = 0.5 - k * base_hz / sample_rate_hz;
    if (!(below > 0.0)) break;
    sum += now * std::min(1.0, below / kFadeShare) / k;
    const double next = 2.0 * first * now - before;
    before = now;
    now = next;
  }
  return sum;
}

}  // namespace

void check_drill_sound(const DrillSoundOptions& options) {
  const auto check = [](double value, double lowest, double highest, const char* what) {
    check_range(value, lowest, highest, "sound of a drill", what);
  };
  check(options.sample_rate_hz, 8000.0, 192000.0, "a sample rate (Hz)");
  check(options.edges, 1.0, 64.0, "a number of edges");
  check(options.volume, 0.0, 4.0, "a volume");
  check(options.reference_rpm, 1.0, 500000.0, "a reference speed (rpm)");
  for (const double level : {options.rotation_level, options.edge_level, options.chip_level, options.air_level}) {
    check(level, 0.0, 1.0, "a level");
  }
  check(options.reference_thrust_n, 1e-3, 1e5, "a reference thrust (N)");
  check(options.reference_power_w, 1e-3, 1e5, "a reference power (W)");
  check(options.droop_per_n_mm, 0.0, 1.0, "a droop (per N mm)");
  check(options.spin_up_s, 1e-3, 10.0, "a time of spinning up (s)");
  check(options.ramp_s, 1e-3, 1.0, "a ramp (s)");
  check(options.chip_open_hz, 20.0, 20000.0, "a centre of noise without bone (Hz)");
  check(options.chip_dense_hz, options.chip_open_hz, 20000.0, "a centre of noise in dense bone, no lower (Hz),");
  check(options.dense_g_cm3, 0.1, 10.0, "a density of dense bone (g/cm3)");
  check(options.chip_tone_exponent, 0.0, 4.0, "an exponent of density");
  check(options.chip_quality, 0.3, 20.0, "a quality of the noise's filter");
  check(options.edge_share_of_chips, 0.0, 1.0, "a share of chips that follows the edges");
}

struct DrillSound::State {
  explicit State(const DrillSoundOptions& given) : options(given) {
    check_drill_sound(options);
    speed.set_time(options.spin_up_s, options.sample_rate_hz);
    for (Ramp* ramp : {&edge, &chip, &tone}) ramp->set_time(options.ramp_s, options.sample_rate_hz);
    tone.jump_to(centre_hz(0.0));
  }

  /// Of the noise of chips: stiffer bone rings higher, as its speed of sound has it.
  double centre_hz(double density_g_cm3) const {
    const double dense = std::min(1.0, density_g_cm3 / options.dense_g_cm3);
    const double hz = options.chip_dense_hz * std::pow(dense, options.chip_tone_exponent);
    return std::min(std::max(hz, options.chip_open_hz), 0.4 * options.sample_rate_hz);
  }

  void set(const DrillSoundInput& input) {
    const double rpm = from_zero(input.rpm, 5e5, "a speed (rpm)");
    const double thrust_n = from_zero(input.thrust_n, 1e5, "a thrust (N)");
    const double torque_n_mm = from_zero(input.torque_n_mm, 1e6, "a torque (N mm)");
    const double density_g_cm3 = from_zero(input.density_g_cm3, 10.0, "a density (g/cm3)");
    speed.set_target(rpm / 60.0 * std::max(0.0, 1.0 - options.droop_per_n_mm * torque_n_mm));
    thrust_share = thrust_n / options.reference_thrust_n;
    // Per turn a second; times the speed it is the power.
    joule_per_turn = 2e-3 * std::numbers::pi * torque_n_mm;
    edge.set_target(options.edge_level * saturated(thrust_share));
    chip.set_target(joule_per_turn);
    tone.set_target(centre_hz(density_g_cm3));
  }

  /// White, of variance 1/3; `which` of two at this sample.
  double white(std::uint64_t which) const { return 2.0 * random_uniform(options.seed, 2 * count + which) - 1.0; }

  double next() {
    const double rate_hz = options.sample_rate_hz;
    const double hz = speed.next();
    turns += hz / rate_hz;
    turns -= std::floor(turns);
    const double of_reference = 60.0 * hz / options.reference_rpm;
    // A drill that stands is silent, whatever presses on it.
    const double turning = std::min(1.0, of_reference);
    const double edge_hz = options.edges * hz;
    const double edge_turns = options.edges * turns - std::floor(options.edges * turns);

    double sound = options.rotation_level * saturated(of_reference) * harmonics(turns, hz, rate_hz, kRotationHarmonics);
    sound += edge.next() * turning * harmonics(edge_turns, edge_hz, rate_hz, kEdgeHarmonics);

    const double centre_hz = tone.next();
    first.tune(centre_hz, options.chip_quality, rate_hz);
    second.tune(centre_hz, options.chip_quality, rate_hz);
    const double band = second.pass(first.pass(white(0)).band).band;
    // Two equal filters let pi/4 of a bandwidth through (7 % less of rms at 6 kHz, where the trapezoidal rule narrows
    // it); white noise of variance 1/3 has its power up to half the rate.
    const double rms = std::sqrt(std::numbers::pi / 6.0 * centre_hz / (options.chip_quality * rate_hz));
    const double power_share = chip.next() * hz / options.reference_power_w;
    double swell = 1.0;
    if (edge_hz < 0.5 * rate_hz) {
      const double fade = std::min(1.0, (0.5 - edge_hz / rate_hz) / kFadeShare);
      swell += fade * options.edge_share_of_chips * std::cos(2.0 * std::numbers::pi * edge_turns);
    }
    // As much of the power is heard, whatever it is: pressure goes with its root.
    sound += options.chip_level * std::sqrt(saturated(power_share)) * swell * band / rms;
    sound += options.air_level * saturated(of_reference) * std::numbers::sqrt3 * white(1);
    ++count;
    return bounded(options.volume * sound);
  }

  double bounded(double sound) {
    const double size = std::abs(sound);
    if (size > kKnee) {
      const double over = (size - kKnee) / (1.0 - kKnee);
      sound = std::copysign(kKnee + (1.0 - kKnee) * over / (1.0 + over), sound);
      ++bent;
    }
    peak = std::max(peak, std::abs(sound));
    return sound;
  }

  DrillSoundOptions options;
  Ramp speed, edge, chip, tone;
  double thrust_share = 0.0, joule_per_turn = 0.0;
  double turns = 0.0;  ///< 0 to 1: where in its turn the bit is
  StateFilter first, second;
  std::uint64_t count = 0, bent = 0;
  double peak = 0.0;
};

DrillSound::DrillSound(const DrillSoundOptions& options) : state_(std::make_unique<State>(options)) {}
DrillSound::~DrillSound() = default;
DrillSound::DrillSound(DrillSound&&) noexcept = default;

void DrillSound::set(const DrillSoundInput& input) { state_->set(input); }

void DrillSound::render(std::span<float> samples) noexcept {
  for (float& sample : samples) sample = static_cast<float>(state_->next());
}

std::uint64_t DrillSound::samples() const noexcept { return state_->count; }
double DrillSound::peak() const noexcept { return state_->peak; }
std::uint64_t DrillSound::bent() const noexcept { return state_->bent; }
double DrillSound::turning_hz() const noexcept { return state_->speed.value(); }
const DrillSoundOptions& DrillSound::options() const noexcept { return state_->options; }

}  // namespace spinaltap
