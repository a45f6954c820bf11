#include "vdb/grid/bone_hash.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/base/hash.h"
#include "vdb/detail/bone_grids.h"

namespace spinaltap {
namespace {

using openvdb::Coord;
using Leaf = openvdb::FloatTree::LeafNodeType;

/// Cubes of a leaf's size, or larger ones of one value.
struct Block {
  Coord origin;
  openvdb::Int32 size = 0;  ///< voxels along each side
  const Leaf* leaf = nullptr;
  float value = 0.0F;  ///< without a leaf
};

/// Tiles up to this size are cut into blocks of a leaf's, so that they hash as the leaves that they stand for.
constexpr openvdb::Int32 kLargestCutTile = 128;

std::vector<Block> active_blocks(const openvdb::FloatGrid& grid) {
  std::vector<Block> blocks;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    if (!leaf->isEmpty()) blocks.push_back({leaf->origin(), Leaf::DIM, leaf.getLeaf(), 0.0F});
  }
  auto tile = grid.tree().cbeginValueOn();
  tile.setMaxDepth(openvdb::FloatGrid::TreeType::ValueOnCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    const openvdb::CoordBBox box = tile.getBoundingBox();
    const openvdb::Int32 size = box.dim().x();
    const openvdb::Int32 step = size <= kLargestCutTile ? openvdb::Int32{Leaf::DIM} : size;
    for (openvdb::Int32 x = 0; x < size; x += step) {
      for (openvdb::Int32 y = 0; y < size; y += step) {
        for (openvdb::Int32 z = 0; z < size; z += step) {
          blocks.push_back({box.min().offsetBy(x, y, z), step, nullptr, *tile});
        }
      }
    }
  }
  std::sort(blocks.begin(), blocks.end(), [](const Block& a, const Block& b) { return a.origin < b.origin; });
  return blocks;
}

void add_block(const Block& block, WordHash64& hash) {
  const std::array<std::int32_t, 4> place{block.origin.x(), block.origin.y(), block.origin.z(), block.size};
  hash.add(place.data(), sizeof place);
  if (block.size != openvdb::Int32{Leaf::DIM}) {
    hash.add(&block.value, sizeof block.value);
    return;
  }
  std::array<float, Leaf::SIZE> values{};
  std::array<std::uint8_t, Leaf::SIZE> active{};
  for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
    const bool is_active = block.leaf == nullptr || block.leaf->isValueOn(i);
    active[i] = is_active ? 1 : 0;
    if (is_active) values[i] = block.leaf == nullptr ? block.value : block.leaf->getValue(i);
  }
  hash.add(active.data(), sizeof active);
  hash.add(values.data(), sizeof values);
}

void add_grid(const openvdb::FloatGrid& grid, WordHash64& hash) {
  for (const Coord& corner : {Coord(0, 0, 0), Coord(1, 0, 0), Coord(0, 1, 0), Coord(0, 0, 1)}) {
    const openvdb::Vec3d place_mm = grid.indexToWorld(corner);
    const std::array<double, 3> numbers{place_mm.x(), place_mm.y(), place_mm.z()};
    hash.add(numbers.data(), sizeof numbers);
  }
  const float background = grid.background();
  hash.add(&background, sizeof background);
  const std::vector<Block> blocks = active_blocks(grid);
  const std::uint64_t count = blocks.size();
  hash.add(&count, sizeof count);
  for (const Block& block : blocks) add_block(block, hash);
}

}  // namespace

std::string bone_hash(const BoneModel& bone) {
  WordHash64 hash;
  add_grid(*bone.grids().sdf, hash);
  add_grid(*bone.grids().hu, hash);
  return hash.hex();
}

}  // namespace spinaltap
