#pragma once

#include <optional>
#include <span>
#include <vector>

#include <tbb/task_arena.h>

#include "core/session/operator/drilled_hole.h"
#include "vdb/remaining/remaining_bone.h"
#include "vdb/remaining/remaining_surface.h"

namespace spinaltap {

/// The bone's surface as it now is, for a display beside a drilling: at each update what the bit swept since the last
/// is taken away and the surface brought up to date where it changed. On the calling thread alone, so that other
/// threads keep their cores.
class LiveMesh {
 public:
  /// Meshes the whole bone once. Nothing is drilled before take_bit().
  explicit LiveMesh(const BoneModel& bone, const RemainingBoneOptions& options = {.undo_bytes = 0});
  LiveMesh(const BoneModel& bone, const DrillBit& bit, double max_jump_mm);
  LiveMesh(const LiveMesh&) = delete;
  LiveMesh& operator=(const LiveMesh&) = delete;

  /// What moves from here on, and has come from nowhere.
  void take_bit(const DrillBit& bit, double max_jump_mm);
  /// Where the bit has come to, straight from where it was. As a session has it: a bit that does not turn takes
  /// nothing, nor do ways of the tip or the base longer than `max_jump_mm`; poses that are not finite are passed
  /// over.
  void update(const ToolInput& input) { update({&input, 1}); }
  /// From each of them to the next.
  void update(std::span<const ToolInput> inputs);
  void update(std::span<const ToolMove> moves);

  /// Holes, as RemainingBone has them.
  void end_hole() { bone_->end_hole(); }
  bool undo_hole();
  bool redo_hole();
  std::size_t holes_to_undo() const { return bone_->holes_to_undo(); }
  void reset();

  /// The blocks that the last update, undoing, redoing or reset changed: what a renderer has to take over.
  std::span<const SurfaceUpdate> updates() const { return updates_; }
  const RemainingSurface& surface() const { return *surface_; }

 private:
  void mesh();
  void drill(const std::vector<std::vector<Pose>>& ways);

  DrillBit bit_;
  double longest_jump_mm_ = 0.0;
  tbb::task_arena one_thread_{1};
  std::optional<RemainingBone> bone_;
  std::optional<RemainingSurface> surface_;
  std::optional<Pose> last_;
  std::vector<SurfaceUpdate> updates_;
};

}  // namespace spinaltap
