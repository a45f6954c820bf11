#pragma once

#include <cstdint>
#include <memory>
#include <span>

namespace spinaltap {

/// What a drill does at a moment, as a session's cycle tells it.
struct DrillSoundInput {
  double rpm = 0.0;  ///< that the motor is set to; 0: off
  double thrust_n = 0.0;
  double torque_n_mm = 0.0;
  double density_g_cm3 = 0.0;  ///< of the bone just ahead of the tip; 0: there is none
};

/// How a drill sounds. Levels: 1 is full scale. docs/sound.md has the sources; what it names none for is an estimate.
struct DrillSoundOptions {
  double sample_rate_hz = 48000.0;
  int edges = 2;  ///< cutting edges that pass a place in one turn
  double volume = 1.0;
  std::uint64_t seed = 1;  ///< of the noise

  double reference_rpm = 1250.0;
  double rotation_level = 0.03;  ///< amplitude at the turning frequency, of a drill in air at the reference speed
  double edge_level = 0.05;      ///< amplitude at the edges' frequency, at the reference thrust
  double reference_thrust_n = 60.0;
  double chip_level = 0.10;  ///< rms of the noise of breaking chips, at the reference power
  double reference_power_w = 4.0;
  double air_level = 0.002;          ///< rms of the motor's own hiss, at the reference speed
  double droop_per_n_mm = 0.0003;    ///< share of the speed that a torque takes
  double spin_up_s = 0.1;            ///< time constant of the speed
  double ramp_s = 0.004;             ///< time constant of all levels
  double chip_open_hz = 1600.0;      ///< centre of the chips' noise with no bone ahead
  double chip_dense_hz = 6300.0;     ///< and in the densest bone
  double dense_g_cm3 = 1.9;          ///< which is this
  double chip_tone_exponent = 0.28;  ///< of density: as the speed of sound goes
  double chip_quality = 1.5;         ///< centre over bandwidth, of each of two filters
  double edge_share_of_chips = 0.5;  ///< how much the chips' noise swells and fades as edges pass
};
/// Rejects values that are not finite or make no sense.
void check_drill_sound(const DrillSoundOptions& options);

/// A drill as it is heard, sample by sample. docs/sound.md tells the model: multiples of the turning frequency,
/// multiples of the edges' frequency that grow with thrust, noise of breaking chips that grows with the power of
/// cutting and gets brighter with density. The same inputs at the same samples give the same bits, however the samples
/// are asked for.
class DrillSound {
 public:
  /// Throws Error as check_drill_sound() does.
  explicit DrillSound(const DrillSoundOptions& options = {});
  ~DrillSound();
  DrillSound(DrillSound&&) noexcept;

  /// From the next sample on; levels and speed follow within their time constants. Negative values count as 0. Throws
  /// Error on what is no number, above 500,000 rpm, 100 kN, 1 kN·m or 10 g/cm³; the sound then goes on as before.
  void set(const DrillSoundInput& input);
  /// The next samples, mono, from -1 to 1. Allocates and locks nothing.
  void render(std::span<float> samples) noexcept;

  std::uint64_t samples() const noexcept;  ///< that were rendered
  double peak() const noexcept;            ///< the largest of them, without its sign
  /// How many were over kKnee and were bent to stay within 1.
  std::uint64_t bent() const noexcept;
  double turning_hz() const noexcept;  ///< as it is now
  /// As they were given.
  const DrillSoundOptions& options() const noexcept;

  static constexpr double kKnee = 0.8;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace spinaltap
