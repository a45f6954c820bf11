#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/ct/bone_identity.h"
#include "core/engine/drill_engine.h"
#include "core/points/point_volume.h"
#include "core/session/drill_session.h"
#include "core/session/operator/drilled_hole.h"

namespace spinaltap {

/// All that decides what a session does, but the bone itself and the operator's poses. A record holds it as JSON
/// (core/files/recorded_setup.h), and replay runs the session from it.
struct SessionSetup {
  std::string bone_hash;        ///< of its grids: bone_hash()
  BoneIdentity bone = {};       ///< which vertebra of which CT it is; empty: not known
  bool takes_other_ct = false;  ///< the path may name another bone: it is drilled in this one all the same
  DrillPath path;
  Material material;
  PointVolumeOptions volume{.radius_mm = 3.0, .spacing_mm = 0.1, .lead_in_mm = 3.0};
  double fine_spacing_mm = 0.0;  ///< as FineSpacing has them
  double fine_near_mm = 1.0;
  double fine_tip_mm = 0.0;
  EngineKind engine = EngineKind::automatic;
  std::optional<Box3> region_mm = {};  ///< of voxels: those with their centre in it, patient LPS; none: the whole bone
  SessionOptions options;
  bool has_clearances = true;
  std::vector<DrilledHole> holes = {};  ///< drilled before: their points are gone when the session begins
  /// Of bones of the same patient that are drilled as well, wherever the tool meets them: voxels only.
  std::vector<std::string> further_bone_hashes = {};
};

/// The box of all that lies within `margin_mm` of a path, from `lead_in_mm` before its entry to its target. Throws
/// Error unless the margin is above 0 and finite.
Box3 region_around(const DrillPath& path, double lead_in_mm, double margin_mm);

/// Throws Error where a region is no box with finite corners and with room between them.
void check_region(const Box3& region_mm);

}  // namespace spinaltap
