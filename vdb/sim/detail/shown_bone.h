#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "core/session/operator/motion_log.h"
#include "core/session/session_setup.h"
#include "vdb/remaining/hole_cutter.h"
#include "vdb/remaining/live_mesh.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// What a session shows of one of its bones: the bone without all that was drilled, and its live mesh. Either is made
/// when first asked for and then brought up to the last of the hole's inputs.
class ShownBone {
 public:
  /// How many readers of a session's MotionLog it is: `first_reader` and those after it.
  static constexpr std::size_t kReaders = 2;

  ShownBone(Bone bone, std::size_t first_reader)
      : bone_(std::move(bone)), cutter_reader_(first_reader), mesh_reader_(first_reader + 1) {}

  const Bone& bone() const { return bone_; }
  /// Without the setup's holes and what the hole under way, `motion`, cut; each move is cut out once.
  HoleCutter& drilled(const SessionSetup& setup, MotionLog& motion);
  /// As Session has it.
  std::vector<SurfaceUpdate> surface_changes(const SessionSetup& setup, MotionLog& motion);

  /// What was made takes in all moves, before they become a hole of the setup.
  void catch_up(const SessionSetup& setup, MotionLog& motion);
  /// The hole that was caught up with has become one of the setup.
  void begin_hole();
  /// Takes out this hole, or where it has no cycles the last of the setup.
  void undo(bool has_cycles);

 private:
  struct LiveHole {
    std::size_t before = 0;  ///< holes that the live mesh could undo when this one began
    bool changes_bone = false;
  };

  HoleCutter& cutter(const SessionSetup& setup);
  void show(const SessionSetup& setup, MotionLog& motion);
  void undo_in_mesh(bool has_cycles);
  void change(const SurfaceUpdate& update);

  Bone bone_;
  std::size_t cutter_reader_, mesh_reader_;
  std::optional<HoleCutter> cutter_;
  std::optional<std::size_t> cut_tool_;  ///< of this hole, that the cutter has; none: it has cut nothing of it
  std::unique_ptr<LiveMesh> live_;
  std::optional<std::size_t> shown_tool_;                ///< that the live mesh has, likewise
  std::vector<LiveHole> live_holes_;                     ///< in the live mesh, this one last
  std::set<std::array<int, 3>> blocks_;                  ///< of the surface, as handed over or waiting
  std::map<std::array<int, 3>, SurfaceUpdate> changes_;  ///< that wait
};

}  // namespace spinaltap
