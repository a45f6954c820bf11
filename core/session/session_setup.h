#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/ct/bone_identity.h"
#include "core/engine/step_result.h"
#include "core/force/drill_force.h"
#include "core/heat/thermal_bone.h"
#include "core/points/material.h"
#include "core/points/point_volume_options.h"
#include "core/session/drill_state.h"
#include "core/session/operator/drilled_hole.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// What gives way in a real tool: a motor that slows down, a bit that bends. Where no source is named, values are
/// estimates.
struct ComplianceOptions {
  bool is_on = false;
  double free_length_mm = 0.0;  ///< of the bit out of its chuck; 0: all of its length
  double young_gpa = 200.0;     ///< of steel
  /// Second moment of area over that of a full cylinder: what the flutes leave of a twist drill.
  double flutes_share = 0.3;
  /// Of a tip that has not bitten on bone: it walks where the surface is steeper to it than this coefficient's angle.
  double friction = 0.25;
  double bite_mm = 0.3;     ///< so deep in bone the hole holds the tip
  double stall_n_mm = 0.0;  ///< torque at which the motor stands; 0: it never slows down
  double spin_up_s = 0.1;   ///< of the motor, towards the speed of its load
};
/// When a session asks the operator to stop. Infinite: never.
struct StopRules {
  double thrust_n = std::numeric_limits<double>::infinity();       ///< at or above
  double clearance_mm = -std::numeric_limits<double>::infinity();  ///< at or below, to the outer surface or the canal
  bool on_breach = false;                                          ///< of either wall
};

/// What a session works out, and when it asks to stop.
struct SessionOptions {
  Spindle spindle = {};
  StopRules stop = {};
  StateRules states = {};
  double max_jump_mm = 50.0;  ///< a longer way of the tip, or of the base, in one cycle is not cut
  /// The tool drills along the path; else, in a milling, neither states nor breakthroughs nor plunges are told: the
  /// depth along the path says nothing of them.
  bool follows_path = true;
  /// There is a planned path. Without one, depths are those of the tip below the bone's surface, as it was before it
  /// was drilled; clearances are the canal's alone, since a tool has to come through the outer surface somewhere. Not
  /// with `follows_path`.
  bool has_path = true;
  /// How warm the bone beside the hole gets, which a tool has to drill that follows the path; none: it is not worked
  /// out, and costs nothing.
  std::optional<HeatOptions> heat = {};
  ComplianceOptions compliance = {};  ///< the bit bends, its tip walks, the motor slows down
  bool has_device = false;  ///< inputs come from a tool that is coupled to a device: forces tell how bone holds it
  /// Forces have DrillForce::support_n, which is felt and recorded, but decides nothing of a session: not where a
  /// compliant tool goes, nor an event, nor what an operator does. A device needs it.
  bool has_support = true;
};
/// Rejects options that are not numbers or make no sense.
void check_session_options(const SessionOptions& options);

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
