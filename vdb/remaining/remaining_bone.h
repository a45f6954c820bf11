#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "core/tool/drill_bit.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

namespace detail {
class HoleGrid;
}  // namespace detail

struct RemainingBoneOptions {
  double voxel_mm = 0.2;  ///< of the grid that is drilled and meshed
  /// Poses are left out where the bit passes them so nearly, in voxels; turns are cut as finely.
  double tolerance_voxels = 0.01;
  /// What may be kept for undo and redo. Beyond it the oldest holes become final.
  std::size_t undo_bytes = std::size_t{256} << 20U;
};

/// A bone as it is while it is drilled: two distances at the voxels near its surface, that to the bone as it was, which
/// nothing changes, and that to all that bits swept. Bone is where the first is below 0 and the second above: the
/// larger of bone and minus hole. Kept apart, both have their own slopes, and the rim between them stays sharp.
///
/// One thread drills, undoes and meshes; others read what RemainingSurface hands over. The same calls give the same
/// bits at any number of threads.
class RemainingBone {
 public:
  /// Resamples the bone: tri-quadratic, a voxel's centre on the origin, near the surface only. A hole that was drilled
  /// into it before (is_drilled()) is a hole here too, but cannot be undone. Throws Error on a voxel
  /// or a tolerance that is not above 0, and on voxels so small that there are over 2^36 in the bone's box.
  explicit RemainingBone(const BoneModel& bone, const RemainingBoneOptions& options = {});
  ~RemainingBone();
  RemainingBone(RemainingBone&&) noexcept;
  RemainingBone& operator=(RemainingBone&&) noexcept;
  RemainingBone(const RemainingBone&) = delete;
  RemainingBone& operator=(const RemainingBone&) = delete;

  /// Takes away what the bit sweeps on its way from each pose (patient LPS, mm) to the next; one pose is a bit that
  /// stands. So calls of a session begin where the last one ended. Forgets what was undone. Throws Error on a bad bit,
  /// on no pose, and on poses that are not sound (see valid_pose); then nothing has changed.
  void drill(const DrillBit& bit, std::span<const Pose> poses);

  /// What is drilled from here on is another hole.
  void end_hole();
  /// Puts back the last hole; false when there is none, or it is final.
  bool undo();
  /// Drills again what undo() put back last; false when there is nothing, or drill() came between.
  bool redo();
  /// The bone as it was at the start. Cannot be undone.
  void reset();
  std::size_t holes_to_undo() const;
  std::size_t holes_to_redo() const;

  /// Before anything was drilled.
  const BoneModel& bone() const;
  double voxel_mm() const;
  /// How far from their surfaces distances are kept; they are clamped to it.
  double band_mm() const;
  /// Voxels of the box that the grid covers, first and last; all beyond are outside.
  std::array<int, 3> first_voxel() const;
  std::array<int, 3> last_voxel() const;
  /// At a voxel, whose centre is its indices times voxel_mm(): the larger of bone and minus hole, mm.
  float value_mm(const std::array<int, 3>& voxel) const;
  /// At a voxel: distance to what bits swept, mm.
  float hole_mm(const std::array<int, 3>& voxel) const;

  /// Of grid, holes and all that is kept for undo and redo.
  std::size_t memory_bytes() const;
  /// Of that, for undo and redo.
  std::size_t undo_memory_bytes() const;

  const detail::HoleGrid& grid() const;
  detail::HoleGrid& grid();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace spinaltap
