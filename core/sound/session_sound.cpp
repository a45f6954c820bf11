#include "core/sound/session_sound.h"

#include <algorithm>
#include <cmath>

#include "core/base/check_range.h"
#include "core/tool/bit_shape.h"

namespace spinaltap {

DrillSoundOptions sound_options(const SessionSetup& setup, DrillSoundOptions options) {
  if (options.edges == 0) options.edges = traits_of(setup.path.bit.shape).edges;
  const ComplianceOptions& compliance = setup.options.compliance;
  if (compliance.is_on && compliance.stall_n_mm > 0.0) {
    options.droop_per_n_mm = std::min(1.0, 1.0 / compliance.stall_n_mm);
    options.spin_up_s = std::max(1e-3, compliance.spin_up_s);
  }
  return options;
}

DrillSoundInput sound_input(const Cycle& cycle, double rpm) {
  return {cycle.input.spindle_on ? rpm : 0.0, cycle.force.thrust_n, cycle.force.torque_n_mm,
          cycle.force.tip_density_g_cm3};
}

SessionSound::SessionSound(const SessionSetup& setup, DrillSoundOptions options)
    : rpm_(setup.options.spindle.rpm), drill_(sound_options(setup, options)) {}

void SessionSound::add(const Cycle& cycle, std::vector<float>& samples) {
  add(cycle.time_s, sound_input(cycle, rpm_), samples);
}

void SessionSound::add(const RecordedCycle& cycle, std::vector<float>& samples) {
  add(cycle.time_s, {cycle.spindle_on != 0 ? rpm_ : 0.0, cycle.thrust_n, cycle.torque_n_mm, cycle.tip_density_g_cm3},
      samples);
}

void SessionSound::add(double time_s, const DrillSoundInput& input, std::vector<float>& samples) {
  check_range(time_s, 0.0, kMaxSeconds, "sound of a session", "a cycle's time (s)");
  // Whole samples since the beginning: no rounding adds up.
  const auto due = static_cast<std::uint64_t>(std::llround(time_s * drill_.options().sample_rate_hz));
  if (due < drill_.samples()) {
    fail("sound of a session: expected a cycle's time (s) no earlier than the last one's, found ", time_s);
  }
  const std::size_t begin = samples.size();
  samples.resize(begin + static_cast<std::size_t>(due - drill_.samples()));
  drill_.render(std::span(samples).subspan(begin));
  drill_.set(input);
}

}  // namespace spinaltap
