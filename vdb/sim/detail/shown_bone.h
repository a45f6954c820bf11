#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "core/session/session_setup.h"
#include "vdb/remaining/hole_cutter.h"
#include "vdb/remaining/live_mesh.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// What a session shows of one of its bones: the bone without all that was drilled, and its live mesh. Either is made
/// when first asked for and then brought up to the last of the hole's inputs.
class ShownBone {
 public:
  explicit ShownBone(Bone bone) : bone_(std::move(bone)) {}

  const Bone& bone() const { return bone_; }
  /// Without the setup's holes and what `inputs` cut; each input is cut out once.
  HoleCutter& drilled(const SessionSetup& setup, std::span<const ToolInput> inputs);
  /// As Session has it.
  std::vector<SurfaceUpdate> surface_changes(const SessionSetup& setup, std::span<const ToolInput> inputs);

  /// What was made takes in all inputs, before they become a hole of the setup.
  void catch_up(const SessionSetup& setup, std::span<const ToolInput> inputs);
  /// The hole that was caught up with has become one of the setup.
  void begin_hole(const SessionSetup& setup);
  /// Takes out this hole, or where it has no inputs the last of the setup.
  void undo(const SessionSetup& setup, bool has_inputs);

 private:
  struct LiveHole {
    std::size_t before = 0;  ///< holes that the live mesh could undo when this one began
    bool changes_bone = false;
  };

  void show(const SessionSetup& setup, std::span<const ToolInput> inputs);
  void undo_in_mesh(const SessionSetup& setup, bool has_inputs);
  void change(const SurfaceUpdate& update);

  Bone bone_;
  std::optional<HoleCutter> cutter_;
  std::size_t cut_ = 0;  ///< of the inputs, in the cutter
  std::unique_ptr<LiveMesh> live_;
  std::size_t shown_ = 0;                                ///< of the inputs, in the live mesh
  std::vector<LiveHole> live_holes_;                     ///< in the live mesh, this one last
  std::set<std::array<int, 3>> blocks_;                  ///< of the surface, as handed over or waiting
  std::map<std::array<int, 3>, SurfaceUpdate> changes_;  ///< that wait
};

}  // namespace spinaltap
