#pragma once

#include <string_view>

#include "core/engine/drill_engine.h"
#include "core/session/session_setup.h"

namespace spinaltap {

/// What is known of a tool's way when a session is set up.
struct MotionClass {
  double max_tilt_deg = 0.0;  ///< of the tool's axis against the path
  bool keeps_to_path = true;  ///< else no cylinder around the path holds it: a milling
  bool trembles = true;       ///< moves aside as well, as a hand does; else it only goes along its axis
  bool is_free = false;       ///< may leave the path, and the cylinder around it: a hand at a device
};

/// Why a session needs voxels: "a region", "a plate"; empty where points serve, which fill a cylinder around the path.
std::string_view why_voxels(const SessionSetup& setup, const MotionClass& way = {});

/// The engine of a session: the setup's own, or where that is `automatic`, the fastest of those that serve. What comes
/// out does not depend on which engine of points it is; voxels are taken only where points cannot serve.
EngineKind chosen_engine(const SessionSetup& setup, const MotionClass& way = {});

/// The setup of a session whose tool goes such a way: its engine is chosen, and where the way leaves the path,
/// SessionOptions::follows_path is off.
SessionSetup setup_for(SessionSetup setup, const MotionClass& way);

}  // namespace spinaltap
