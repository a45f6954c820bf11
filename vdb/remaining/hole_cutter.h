#pragma once

#include <memory>
#include <span>

#include "core/session/operator/drilled_hole.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// A bone and all that was drilled of it: what a picture needs, without the grid of what is left.
struct CutHole {
  BoneModel bone;                                 ///< as the cutter was given it
  std::shared_ptr<const detail::BoneGrids> hole;  ///< its `hole`: all of it
};

/// Cuts what bits sweep out of a bone's grids: the larger of the bone's distance and minus the hole's, to a hundredth
/// of a voxel. The bone as it was and the hole are kept beside it, see is_drilled(). The same poses give the same bits,
/// in however many calls they come and at any number of threads.
class HoleCutter {
 public:
  explicit HoleCutter(BoneModel bone);
  ~HoleCutter();
  HoleCutter(HoleCutter&&) noexcept;
  HoleCutter& operator=(HoleCutter&&) noexcept;

  /// What cuts from here on, and has come from nowhere. Throws Error on a bad bit.
  void take_bit(const DrillBit& bit, double max_jump_mm);
  /// Where it has come to next: see cutting_ways().
  void add(std::span<const ToolInput> inputs);
  void add(std::span<const ToolMove> moves);
  /// A whole hole. Throws Error on a bad bit, and on poses that are not sound (see valid_pose).
  void add(const DrilledHole& hole);

  /// Without all so far; the bone itself, where that is nothing of it. Stays as it is until something is added.
  const BoneModel& bone();
  /// The same as view_bone() takes it, quicker.
  CutHole hole();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The bone without holes. Throws Error as HoleCutter does.
BoneModel without_holes(const BoneModel& bone, std::span<const DrilledHole> holes);

}  // namespace spinaltap
