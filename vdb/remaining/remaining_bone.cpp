#include "vdb/remaining/remaining_bone.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include "core/base/error.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/remaining/detail/hole_grid.h"
#include "vdb/remaining/detail/sampled_hole.h"

namespace spinaltap {
namespace {

using detail::BlockLattice;
using detail::HoleGrid;

/// What undoing or redoing one hole takes: blocks to be put in place of those that are there.
struct SavedHole {
  HoleGrid::SavedBlocks blocks;

  std::size_t bytes() const {
    std::size_t sum = blocks.capacity() * sizeof(blocks[0]);
    for (const auto& [index, block] : blocks) sum += block == nullptr ? 0 : block->memory_bytes();
    return sum;
  }
};

std::vector<Pose> checked_poses(const DrillBit& bit, std::span<const Pose> poses) {
  if (poses.empty()) fail("drilling: expected a pose or more");
  std::vector<Pose> sound;
  for (const Pose& pose : poses) {
    const std::optional<Pose> one = valid_pose(pose, bit);
    if (!one) {
      fail("drilling: expected a finite tip and an axis of length 1, of a plate also a side across it, found tip ",
           pose.tip_mm.transpose(), ", axis ", pose.axis.transpose(), ", side ", pose.side.transpose());
    }
    sound.push_back(*one);
  }
  return sound;
}

/// A voxel's block and its place there.
std::pair<BlockLattice::Index3, std::size_t> place_of(const std::array<int, 3>& voxel) {
  BlockLattice::Index3 block{};
  std::array<int, 3> within{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    block[axis] = voxel[axis] >> 3;
    within[axis] = voxel[axis] & 7;
  }
  return {block, BlockLattice::offset(within[0], within[1], within[2])};
}

}  // namespace

struct RemainingBone::State {
  BoneModel bone;
  RemainingBoneOptions options;
  HoleGrid grid;
  std::optional<DrillBit> last_bit;
  std::deque<SavedHole> undo;  ///< the last is the hole that is being drilled, where is_open
  std::deque<SavedHole> redo;
  std::size_t saved_bytes = 0;  ///< of all but the open hole
  bool is_open = false;
  bool is_open_final = false;  ///< the open hole's blocks were too many to keep
  std::uint64_t epoch = 1;

  State(const BoneModel& model, const RemainingBoneOptions& given)
      : bone(before_drilling(model)), options(given), grid(grid_of(model, bone, given.voxel_mm)) {}

  static HoleGrid grid_of(const BoneModel& model, const BoneModel& before, double voxel_mm) {
    auto resampled = std::make_shared<const detail::ResampledBone>(detail::resample_bone(before, voxel_mm));
    HoleGrid::SavedBlocks drilled;
    if (is_drilled(model)) drilled = detail::sample_hole(*model.grids().hole, *resampled);
    return HoleGrid(std::move(resampled), std::move(drilled));
  }

  void close() {
    if (!is_open) return;
    is_open = false;
    ++epoch;
    if (is_open_final || undo.back().blocks.empty()) {
      undo.pop_back();
    } else {
      saved_bytes += undo.back().bytes();
      keep_within_bounds();
    }
    is_open_final = false;
  }

  void keep_within_bounds() {
    while (saved_bytes > options.undo_bytes && !undo.empty()) {
      saved_bytes -= undo.front().bytes();
      undo.pop_front();
    }
    while (saved_bytes > options.undo_bytes && !redo.empty()) {
      saved_bytes -= redo.front().bytes();
      redo.pop_front();
    }
  }

  /// While a hole is drilled, older ones go first to make room for it; it goes itself where that is not enough.
  void make_room_for_open() {
    if (is_open_final) {
      undo.back().blocks.clear();
      return;
    }
    const std::size_t open_bytes = undo.back().bytes();
    while (saved_bytes + open_bytes > options.undo_bytes && undo.size() > 1) {
      saved_bytes -= undo.front().bytes();
      undo.pop_front();
    }
    if (saved_bytes + open_bytes <= options.undo_bytes) return;
    is_open_final = true;
    undo.back() = {};
  }

  void forget_redo() {
    for (const SavedHole& hole : redo) saved_bytes -= hole.bytes();
    redo.clear();
  }

  bool move_last(std::deque<SavedHole>& from, std::deque<SavedHole>& to) {
    if (from.empty()) return false;
    SavedHole hole = std::move(from.back());
    from.pop_back();
    saved_bytes -= hole.bytes();
    for (auto& [index, block] : hole.blocks) block = grid.exchange(index, std::move(block));
    ++epoch;
    saved_bytes += hole.bytes();
    to.push_back(std::move(hole));
    keep_within_bounds();
    return true;
  }
};

RemainingBone::RemainingBone(const BoneModel& bone, const RemainingBoneOptions& options) {
  if (!(options.tolerance_voxels > 0.0)) {
    fail("remaining bone: expected a tolerance above 0 voxels, found ", options.tolerance_voxels);
  }
  state_ = std::make_unique<State>(bone, options);
}

RemainingBone::~RemainingBone() = default;
RemainingBone::RemainingBone(RemainingBone&&) noexcept = default;
RemainingBone& RemainingBone::operator=(RemainingBone&&) noexcept = default;

void RemainingBone::drill(const DrillBit& bit, std::span<const Pose> poses) {
  constexpr double kLongestVoxels = 8.0;
  check_bit(bit);
  const std::vector<Pose> sound = checked_poses(bit, poses);
  State& state = *state_;
  state.forget_redo();
  if (state.last_bit && !(*state.last_bit == bit)) state.grid.change_bit();
  state.last_bit = bit;
  if (!state.is_open) {
    state.undo.emplace_back();
    state.is_open = true;
  }
  const double voxel_mm = state.options.voxel_mm;
  for (const detail::BitSweep& sweep :
       detail::cut_into_sweeps(bit, sound, state.options.tolerance_voxels * voxel_mm, kLongestVoxels * voxel_mm)) {
    state.grid.drill(sweep, state.epoch, state.undo.back().blocks);
  }
  state.make_room_for_open();
}

void RemainingBone::end_hole() { state_->close(); }

bool RemainingBone::undo() {
  // A hole that cannot be put back is not passed over.
  if (state_->is_open && state_->is_open_final) return false;
  state_->close();
  return state_->move_last(state_->undo, state_->redo);
}

bool RemainingBone::redo() {
  state_->close();
  return state_->move_last(state_->redo, state_->undo);
}

void RemainingBone::reset() {
  state_->undo.clear();
  state_->redo.clear();
  state_->saved_bytes = 0;
  state_->is_open = false;
  state_->is_open_final = false;
  ++state_->epoch;
  state_->grid.clear();
}

std::size_t RemainingBone::holes_to_undo() const {
  const bool is_last_none = state_->is_open && (state_->is_open_final || state_->undo.back().blocks.empty());
  return state_->undo.size() - (is_last_none ? 1 : 0);
}

std::size_t RemainingBone::holes_to_redo() const { return state_->redo.size(); }

const BoneModel& RemainingBone::bone() const { return state_->bone; }
double RemainingBone::voxel_mm() const { return state_->options.voxel_mm; }
double RemainingBone::band_mm() const { return static_cast<double>(state_->grid.bone().band_mm); }

std::array<int, 3> RemainingBone::first_voxel() const {
  const BlockLattice& lattice = state_->grid.bone().lattice;
  return {8 * lattice.low[0], 8 * lattice.low[1], 8 * lattice.low[2]};
}

std::array<int, 3> RemainingBone::last_voxel() const {
  const BlockLattice& lattice = state_->grid.bone().lattice;
  std::array<int, 3> last{};
  for (std::size_t axis = 0; axis < 3; ++axis) last[axis] = 8 * (lattice.low[axis] + lattice.size[axis]) - 1;
  return last;
}

float RemainingBone::value_mm(const std::array<int, 3>& voxel) const {
  const auto [block, offset] = place_of(voxel);
  const detail::ResampledBone& bone = state_->grid.bone();
  if (!bone.lattice.holds(block)) return bone.band_mm;
  return std::max(bone.at(bone.lattice.index(block), offset), -hole_mm(voxel));
}

float RemainingBone::hole_mm(const std::array<int, 3>& voxel) const {
  const auto [block, offset] = place_of(voxel);
  const detail::ResampledBone& bone = state_->grid.bone();
  if (!bone.lattice.holds(block)) return bone.band_mm;
  return state_->grid.hole_mm(bone.lattice.index(block), offset);
}

std::size_t RemainingBone::memory_bytes() const {
  return state_->grid.bone().memory_bytes() + state_->grid.memory_bytes() + undo_memory_bytes();
}

std::size_t RemainingBone::undo_memory_bytes() const {
  return state_->saved_bytes + (state_->is_open ? state_->undo.back().bytes() : 0);
}

const detail::HoleGrid& RemainingBone::grid() const { return state_->grid; }
detail::HoleGrid& RemainingBone::grid() { return state_->grid; }

}  // namespace spinaltap
