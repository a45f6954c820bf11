#include "vdb/detail/bone_samplers.h"

#include <openvdb/openvdb.h>

#include <bit>
#include <cstdint>
#include <memory>
#include <unordered_map>

#include "core/base/error.h"
#include "vdb/detail/bone_grids.h"

namespace spinaltap::detail {
namespace {

using openvdb::CoordBBox;
using openvdb::FloatTree;
using Leaf = FloatTree::LeafNodeType;

static_assert(Leaf::DIM == BlockTable::kSide);

IndexMap index_map_of(const openvdb::FloatGrid& grid, const char* name) {
  if (!grid.transform().isLinear()) fail("bone model: expected the grid ", name, " without perspective");
  const openvdb::Mat4d to_patient = grid.transform().baseMap()->getAffineMap()->getMat4();
  IndexMap map;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      if (row != column && to_patient[row][column] != 0.0) map.axis_aligned = false;
    }
  }
  if (map.axis_aligned) {
    for (int axis = 0; axis < 3; ++axis) {
      map.origin_mm[axis] = to_patient[3][axis];
      map.per_mm[axis] = 1.0 / to_patient[axis][axis];
    }
    return map;
  }
  const openvdb::Mat4d to_index = to_patient.inverse();
  // OpenVDB multiplies row vectors.
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) map.matrix(row, column) = to_index[column][row];
    map.offset_index[row] = to_index[3][row];
  }
  return map;
}

/// Calls `visit(box, value)` for each tile, on any level of the tree, that is not background.
template <class Visit>
void for_each_tile(const FloatTree& tree, const Visit& visit) {
  auto tile = tree.cbeginValueAll();
  tile.setMaxDepth(FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    if (*tile == tree.background()) continue;
    CoordBBox box;
    tile.getBoundingBox(box);
    visit(box, *tile);
  }
}

/// A table's blocks of one value, made when first asked for.
class Constants {
 public:
  Constants(BlockTable& table, const char* name) : table_(table), name_(name) {}
  const float* of(float value) {
    constexpr std::size_t kMax = 1 << 16;
    const float*& first = first_values_[std::bit_cast<std::uint32_t>(value)];
    if (first == nullptr) {
      if (table_.constants.size() == kMax) fail("bone model: over ", kMax, " kinds of tiles in the grid ", name_);
      auto block = std::make_unique<BlockTable::Block>();
      block->fill(value);
      first = block->data();
      table_.constants.push_back(std::move(block));
    }
    return first;
  }

 private:
  BlockTable& table_;
  const char* name_;
  std::unordered_map<std::uint32_t, const float*> first_values_;
};

BlockTable block_table_of(const openvdb::FloatGrid& grid, const char* name) {
  const FloatTree& tree = grid.tree();
  BlockTable table;
  table.background = tree.background();
  CoordBBox content;
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) content.expand(leaf->getNodeBoundingBox());
  for_each_tile(tree, [&](const CoordBBox& box, float) { content.expand(box); });
  if (content.empty()) return table;

  // A bone's surface fills its box well. What is far emptier is a damaged file, and would take all memory.
  constexpr double kBlocksForFree = 1 << 22;
  constexpr double kBlocksPerLeaf = 256.0;
  constexpr int kFarthestVoxel = 1 << 28;
  double count = 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (content.min()[axis] < -kFarthestVoxel || content.max()[axis] > kFarthestVoxel) {
      fail("bone model: expected voxels up to index ", kFarthestVoxel, " in the grid ", name, ", found others");
    }
    count *= (static_cast<double>(content.max()[axis]) - content.min()[axis] + 1.0) / BlockTable::kSide + 2.0;
  }
  if (!(count <= kBlocksForFree + kBlocksPerLeaf * static_cast<double>(tree.leafCount()))) {
    fail("bone model: the grid ", name, " spreads ", tree.leafCount(), " leaves over a box that has room for ", count,
         ": no bone, or damaged");
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    table.low[axis] = content.min()[axis] - BlockTable::kSide;
    table.size[axis] = (content.max()[axis] - content.min()[axis] + 1) / BlockTable::kSide + 2;
  }

  Constants constants(table, name);
  table.blocks.assign(static_cast<std::size_t>(table.size[0]) * static_cast<std::size_t>(table.size[1]) *
                          static_cast<std::size_t>(table.size[2]),
                      constants.of(table.background));
  const auto block_at = [&](int x, int y, int z) -> const float*& {
    const auto block = [](int voxel, int low) { return static_cast<unsigned>(voxel - low) / BlockTable::kSide; };
    return table.blocks[table.offset(block(x, table.low[0]), block(y, table.low[1]), block(z, table.low[2]))];
  };
  for_each_tile(tree, [&](const CoordBBox& box, float value) {
    const float* const block = constants.of(value);
    for (int x = box.min().x(); x <= box.max().x(); x += BlockTable::kSide) {
      for (int y = box.min().y(); y <= box.max().y(); y += BlockTable::kSide) {
        for (int z = box.min().z(); z <= box.max().z(); z += BlockTable::kSide) block_at(x, y, z) = block;
      }
    }
  });
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    const openvdb::Coord& origin = leaf->origin();
    block_at(origin.x(), origin.y(), origin.z()) = leaf->buffer().data();
  }
  find_even_blocks(table);
  return table;
}

}  // namespace

BoneSamplers make_samplers(const BoneGrids& grids) {
  BlockTable distance = block_table_of(*grids.sdf, "sdf");
  find_signs(distance);
  return {GridSampler(std::move(distance), index_map_of(*grids.sdf, "sdf")),
          GridSampler(block_table_of(*grids.hu, "hu"), index_map_of(*grids.hu, "hu"))};
}

}  // namespace spinaltap::detail
