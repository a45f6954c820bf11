#pragma once

#include <cstdint>

#include "apps/link/link_server.h"
#include "core/base/progress.h"
#include "vdb/sim/session.h"

namespace spinaltap {

struct LinkLoopOptions {
  /// Cycles a second that are meant: where poses come, a cycle follows at once, but never more than twice as many.
  double rate_hz = 1000.0;
  double longest_s = 600.0;  ///< ends then, at the latest
  TrackingOptions tracking = {};
  bool wants_priority = true;
};

struct LinkLoopReport {
  std::uint64_t cycles = 0;
  std::uint64_t poses = 0;     ///< transforms of the tool that came
  std::uint64_t unseen = 0;    ///< of them, those that gave no pose: not valid, or no reference
  std::uint64_t merged = 0;    ///< those that a later one took the place of before its cycle
  std::uint64_t gaps = 0;      ///< returns after silence, whose way was not cut
  std::uint64_t silences = 0;  ///< times that forces went to zero because no pose came
  double longest_gap_s = 0.0;  ///< between two cycles
  double seconds = 0.0;
  TimeSpread step_time;   ///< of a cycle, observers included
  bool is_ended = false;  ///< by a command
  bool has_priority = false;
};

/// Forces that are told while no pose comes: as they were for 20 ms, then falling to nothing at 50 ms.
double force_share(double silent_s);

/// The loop of a linked session, in a thread of its own: takes the tracked poses as they come, runs a cycle for each,
/// and gives the server what came of it. A cycle's time is that between the arrivals of its pose and the one before.
///
/// No cycle is run without a pose. After silence for longer than TrackingOptions::stale_s, as before the first pose,
/// the bit is put where it is with the spindle off, so that what lies between is not cut. Poses of tools but plates
/// have no side, as records have none.
///
/// `observe` is called in that thread and must not wait. Ends at a command, after longest_s, or where `progress` is
/// cancelled; then all is as it was, and a record can be closed. Throws Error on bad options, and what `observe`
/// throws.
LinkLoopReport run_link(Session& session, LinkServer& server, const LinkLoopOptions& options,
                        const CycleObserver& observe = {}, const Progress& progress = {});

}  // namespace spinaltap
