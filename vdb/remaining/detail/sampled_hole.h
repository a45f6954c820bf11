#pragma once

#include <openvdb/openvdb.h>

#include <memory>
#include <utility>
#include <vector>

#include "vdb/remaining/detail/block_lattice.h"
#include "vdb/remaining/detail/resampled_bone.h"

namespace spinaltap::detail {

/// Blocks of a bone's lattice with the distance to a hole that a level set holds, and its gradient, by
/// differences over the level set's own voxels. Blocks that it does not reach are left out; the others are in order.
std::vector<std::pair<std::size_t, std::shared_ptr<HoleBlock>>> sample_hole(const openvdb::FloatGrid& hole,
                                                                            const ResampledBone& bone);

}  // namespace spinaltap::detail
