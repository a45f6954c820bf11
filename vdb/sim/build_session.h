#pragma once

#include <memory>
#include <span>

#include "core/base/scalar_field.h"
#include "core/session/drill_session.h"
#include "core/session/session_setup.h"
#include "vdb/sim/bone.h"
#include "vdb/sim/drilled_bone.h"

namespace spinaltap {

/// A session with all it stands on. Not to be moved while it runs.
struct BuiltSession {
  DrilledBone bone;
  std::unique_ptr<ClearanceField> clearances;  ///< null where the setup has none
  std::unique_ptr<DrillSession> session;

  /// Another tool from the next cycle on: DrillSession::set_tool().
  void set_tool(const SessionSetup& setup, const DrillBit& bit) { session->set_tool(bit, bone.engine_for(setup, bit)); }
};
/// Fills what is drilled and makes the session. `exact` decides which points are bone, in place of the bone's grid,
/// where it is given. `clearances`: another session's of the same bone and path, which saves working them out again.
/// Throws Error where the path misses the bone.
BuiltSession build_session(const Bone& bone, const SessionSetup& setup, const Progress& progress = {},
                           const ScalarField* exact = nullptr, const ClearanceField* clearances = nullptr);
/// Of several bones of one patient, which must be those that name_bones() gave the setup: the path is the first's, the
/// tool takes what it meets of all. Clearances are to the walls of all of them together.
BuiltSession build_session(std::span<const Bone> bones, const SessionSetup& setup, const Progress& progress = {},
                           const ScalarField* exact = nullptr, const ClearanceField* clearances = nullptr);
/// What stands for a path in the setup of a session without one: a line through the bones, or the setup's region, which
/// nothing is told by. Throws Error where there is no bone.
DrillPath line_without_path(std::span<const Bone> bones, const SessionSetup& setup);
/// Their fingerprints. Throws Error where there is none, or one is there twice.
void name_bones(SessionSetup& setup, std::span<const Bone> bones);

}  // namespace spinaltap
