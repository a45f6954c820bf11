#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap::detail {

/// A leaf of 8 x 8 x 8 voxels with a word of 64 occupied bits for each x. Nodes above it of 4 x 4 x 4 leaves, and of
/// 4 x 4 x 4 of those: a tool of a few millimetres meets few of either.
using VoxelLeafNode = openvdb::tree::LeafNode<std::uint8_t, 3>;
using VoxelNode = openvdb::tree::InternalNode<VoxelLeafNode, 2>;
using VoxelBranch = openvdb::tree::InternalNode<VoxelNode, 2>;
using VoxelTree = openvdb::tree::Tree<openvdb::tree::RootNode<openvdb::tree::InternalNode<VoxelBranch, 4>>>;

/// The tree of a VoxelBone. Active voxels live; values are CT numbers, see hu_byte.h.
struct VoxelLeaves {
  double voxel_mm = 0.1;
  Box3 region_mm;
  VoxelTree tree;
};

}  // namespace spinaltap::detail
