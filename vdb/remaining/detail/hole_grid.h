#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "vdb/remaining/detail/block_drill.h"
#include "vdb/remaining/detail/resampled_bone.h"

namespace spinaltap::detail {

/// Bits that tell which voxels of a block are bone: bit 8 y + z of layer x.
using InsideBits = std::array<std::uint64_t, BlockLattice::kSide>;

/// What was drilled out of a bone, as the distance to all that bits swept, beside the bone's own. Voxels count as bone
/// where the bone's distance is below 0 and the hole's above. Only voxels in the bone's reach are kept.
class HoleGrid {
 public:
  using BlockPtr = std::shared_ptr<HoleBlock>;
  using SavedBlocks = std::vector<std::pair<std::size_t, BlockPtr>>;

  /// `start`: what was drilled before, to which clear() goes back.
  explicit HoleGrid(std::shared_ptr<const ResampledBone> bone, SavedBlocks start = {});

  const ResampledBone& bone() const { return *bone_; }
  float hole_mm(std::size_t block, std::size_t offset) const {
    const HoleBlock* hole = holes_[block].get();
    return hole == nullptr ? bone_->band_mm : hole->distance_mm[offset];
  }
  const HoleBlock* hole(std::size_t block) const { return holes_[block].get(); }
  const InsideBits& inside(std::size_t block) const { return inside_[inside_places_[block]]; }

  /// Takes away what a bit swept. Blocks that change are copied before, unless drill() of the same `epoch` did so
  /// already; the copied ones (null: nothing drilled there yet) are appended to `before`.
  void drill(const BitSweep& sweep, std::uint64_t epoch, SavedBlocks& before);
  /// To be called before a bit of another shape drills.
  void change_bit();
  /// Puts a block in place of another (null: nothing drilled there), which is returned.
  BlockPtr exchange(std::size_t block, BlockPtr hole);
  /// As at the start.
  void clear();

  /// What changed since the last call, in order of the blocks.
  std::vector<std::pair<std::size_t, BlockChange>> take_changes();

  std::size_t memory_bytes() const;

 private:
  /// How far the bit may move, from where it was when a block was looked at, before a voxel there can change.
  struct Look {
    Pose from;
    double slack_mm = -1.0;   ///< below 0: not known
    std::uint64_t epoch = 0;  ///< in which the block became this grid's own
    bool is_done = false;     ///< nothing is left there that could change
  };

  std::vector<std::size_t> blocks_in_reach(const BitSweep& sweep) const;
  bool may_change(const BitSweep& sweep, std::size_t block) const;
  void find_inside(std::size_t block);

  std::shared_ptr<const ResampledBone> bone_;
  BlockPtr gone_;  ///< stands for all blocks that are hole throughout
  std::vector<BlockPtr> holes_;
  SavedBlocks start_;
  std::vector<std::uint32_t> inside_places_;
  std::vector<InsideBits> inside_;
  std::unordered_map<std::size_t, Look> looks_;
  std::unordered_map<std::size_t, BlockChange> changes_;
};

}  // namespace spinaltap::detail
