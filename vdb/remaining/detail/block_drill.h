#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include "vdb/remaining/detail/bit_sweep.h"
#include "vdb/remaining/detail/block_lattice.h"
#include "vdb/remaining/detail/resampled_bone.h"

namespace spinaltap::detail {

/// A block while a sweep is taken away from it, and what that came to.
struct BlockDrill {
  std::size_t block = 0;
  std::shared_ptr<HoleBlock> hole;  ///< as it is now; null: nothing drilled there yet
  bool is_own = false;              ///< `hole` may be written; else it is copied before the first change
  bool is_copied = false;
  std::shared_ptr<HoleBlock> before{};  ///< what was copied; null: nothing drilled there
  BlockChange change{};
  /// How far the bit may move from the sweep's middle() before a voxel there can change.
  double slack_mm = std::numeric_limits<double>::infinity();
  bool is_done = true;  ///< nothing is left there that could change
};

/// Of a block's first voxel's centre to its last's, halved: the middle.
Vec3 block_middle_mm(const BlockLattice& lattice, std::size_t block);
/// From the middle of a block to its outermost voxels.
double block_reach_mm(const BlockLattice& lattice);

/// Takes away what a bit swept: at each voxel that is bone, or nearly, the hole's distance becomes the least of what it
/// was and that to the sweep. `drill` names the block and holds it as it is; the rest is filled in.
void drill_block(const ResampledBone& bone, const BitSweep& sweep, BlockDrill& drill);

}  // namespace spinaltap::detail
