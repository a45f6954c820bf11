#pragma once

#include <vector>

#include "core/session/cycle.h"
#include "core/session/record/session_record.h"
#include "core/session/session_setup.h"
#include "core/sound/drill_sound.h"

namespace spinaltap {

/// Options with the speed's droop of the setup's motor, where that gives way, and with the edges of its tool, where
/// `options` have 0.
DrillSoundOptions sound_options(const SessionSetup& setup, DrillSoundOptions options);
/// What a cycle lets be heard, of a spindle set to `rpm`.
DrillSoundInput sound_input(const Cycle& cycle, double rpm);

/// The sound of a session, cycle by cycle, live or out of a record: what a cycle tells is heard from its own time on
/// until the next cycle's. A cycle without spindle lets the drill run down.
class SessionSound {
 public:
  /// Speed and its droop are the setup's where its motor gives way, the edges its tool's, whatever `options` say; 0
  /// `edges` there: the tool's, else theirs. Throws Error as DrillSound does.
  explicit SessionSound(const SessionSetup& setup, DrillSoundOptions options = without_edges());

  /// Appends the samples from the last cycle's time to this one's; takes over what this one tells. Throws Error where
  /// time goes back, or goes on by more than kMaxSeconds in all, and as DrillSound::set() does.
  void add(const Cycle& cycle, std::vector<float>& samples);
  void add(const RecordedCycle& cycle, std::vector<float>& samples);

  const DrillSound& drill() const { return drill_; }
  /// Default options whose edges are the tool's.
  static DrillSoundOptions without_edges() { return {.edges = 0}; }
  static constexpr double kMaxSeconds = 3600.0;

 private:
  void add(double time_s, const DrillSoundInput& input, std::vector<float>& samples);

  double rpm_;
  DrillSound drill_;
};

}  // namespace spinaltap
