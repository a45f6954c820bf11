#pragma once

#include <cstdint>
#include <vector>

#include "vdb/grid/bone_model.h"
#include "vdb/remaining/detail/block_lattice.h"

namespace spinaltap::detail {

/// How far from a surface, in voxels, distances are kept beside it. Both ends of an edge that a surface cuts lie within
/// one voxel of it; the rest is for slopes that are not quite 1.
inline constexpr double kBandVoxels = 1.5;

/// A bone's distance at the voxels of a lattice: tri-quadratic from the bake (mm, negative inside), clamped to the
/// band. Nothing changes it.
struct ResampledBone {
  using Values = std::array<float, BlockLattice::kVoxels>;
  static constexpr std::int32_t kOutside = -1;
  static constexpr std::int32_t kInside = -2;

  BlockLattice lattice;
  float band_mm = 0.0F;
  std::vector<std::int32_t> places;  ///< of each block: kOutside or kInside throughout, or where in `values`
  std::vector<Values> values;

  float at(std::size_t block, std::size_t offset) const {
    const std::int32_t place = places[block];
    if (place < 0) return place == kOutside ? band_mm : -band_mm;
    return values[static_cast<std::size_t>(place)][offset];
  }
  std::size_t memory_bytes() const {
    return places.capacity() * sizeof(std::int32_t) + values.capacity() * sizeof(Values);
  }
};

/// Samples the bone near its surface, with two blocks of the outside around. Distances are right to one voxel from the
/// surface; further away they may be those of the band's edge. Throws Error on a voxel that is not above 0 and on over
/// 2^27 blocks.
ResampledBone resample_bone(const BoneModel& bone, double voxel_mm);

}  // namespace spinaltap::detail
