#pragma once

#include <string>
#include <vector>

#include "core/engine/drill_engine.h"
#include "core/points/point_volume.h"
#include "core/session/drill_session.h"
#include "core/session/operator/drilled_hole.h"

namespace spinaltap {

/// All that decides what a session does, but the bone itself and the operator's poses. A record holds it as JSON
/// (core/files/recorded_setup.h), and replay runs the session from it.
struct SessionSetup {
  std::string bone_hash;  ///< of its grids: bone_hash()
  DrillPath path;
  Material material;
  PointVolumeOptions volume{.radius_mm = 3.0, .spacing_mm = 0.1, .lead_in_mm = 3.0};
  double fine_spacing_mm = 0.0;  ///< as FineSpacing has them
  double fine_near_mm = 1.0;
  double fine_tip_mm = 0.0;
  EngineKind engine = EngineKind::ring;
  SessionOptions options;
  bool has_clearances = true;
  std::vector<DrilledHole> holes = {};  ///< drilled before: their points are gone when the session begins
};

}  // namespace spinaltap
