#pragma once

#include <string>

#include "apps/report/hand_choice.h"
#include "vdb/sim/build_session.h"

namespace spinaltap {

/// How the chosen path is drilled.
struct DrillPlan {
  std::string hand = "on-path";  ///< on-path, off-path, tilted, tremor, push: as `spinaltap drill --hand`
  double feed_mm_s = 1.0;        ///< of all hands but push
  double push_n = 40.0;          ///< of the hand push
  bool stops_on_breach = false;  ///< of the outer surface or the canal
  double speed = 1.0;            ///< of the clock: 2 is twice life's; 0: as fast as it goes
};

HandChoice hand_choice(const DrillPlan& plan);

/// The session that drills a path so, with the shipped laws of density and resistance. Throws Error where they are not
/// there.
SessionSetup session_setup(const DrillPath& path, const DrillPlan& plan);

}  // namespace spinaltap
