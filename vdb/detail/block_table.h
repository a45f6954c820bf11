#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace spinaltap::detail {

/// Two bits for each of the 8 x 8 x 8 cells that start in a block: whether all eight corners are negative, and whether
/// some are and some are not. A cell's bits lie side by side in one cache line.
struct alignas(64) CellSigns {
  struct Layer {
    std::uint64_t negative = 0;  ///< bit 8 y + z
    std::uint64_t mixed = 0;
  };
  std::array<Layer, 8> layers;  ///< one for each x
};

/// Where a grid's values lie, in blocks of 8 x 8 x 8 voxels: a dense table over the box that holds all that differs
/// from the background, and a layer of background blocks around it. Leaves keep their values where the grid has them;
/// tiles of one value share one block that is full of it.
struct BlockTable {
  static constexpr int kSide = 8;
  static constexpr int kValues = kSide * kSide * kSide;
  /// Values of one block, z fastest, then y, as in OpenVDB's leaves.
  using Block = std::array<float, kValues>;

  std::array<int, 3> low{};          ///< voxel index of the first block's first voxel
  std::array<int, 3> size{};         ///< blocks along x, y and z; 0 for a grid of background only
  std::vector<const float*> blocks;  ///< first value of each block; block indices run like the voxels', z fastest
  std::vector<std::unique_ptr<const Block>> constants;  ///< the shared blocks
  float background = 0.0F;
  /// For each block whether it and all around it are one and the same shared block, so that any stencil of a voxel of
  /// it finds this one value.
  std::vector<std::uint8_t> is_even;

  /// Where to find the sign of each cell (of 2 x 2 x 2 voxels) without its values: for each block the place of its
  /// bits. Empty when not wanted.
  std::vector<std::uint32_t> sign_places;
  std::vector<CellSigns> signs;

  /// Of the block (x, y, z) in `blocks` and `sign_places`.
  std::size_t offset(unsigned x, unsigned y, unsigned z) const {
    return (std::size_t{x} * static_cast<unsigned>(size[1]) + y) * static_cast<unsigned>(size[2]) + z;
  }
};

/// For what counts in unsigned numbers.
constexpr unsigned kTableSide = BlockTable::kSide;

/// Fills `is_even`.
void find_even_blocks(BlockTable& table);

/// Fills `sign_places` and `signs`.
void find_signs(BlockTable& table);

}  // namespace spinaltap::detail
