#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap::detail {

/// Voxels in blocks of 8 x 8 x 8 over a box. A voxel's centre is its indices times `voxel_mm` (patient LPS), so that
/// one lies on the origin, as in baked bones. Block (x, y, z) holds voxels 8 x to 8 x + 7, and so on.
struct BlockLattice {
  using Index3 = std::array<int, 3>;
  static constexpr int kSide = 8;
  static constexpr int kVoxels = kSide * kSide * kSide;

  Index3 low{};   ///< first block
  Index3 size{};  ///< blocks along x, y and z
  double voxel_mm = 0.2;

  std::size_t count() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
  }
  bool holds(const Index3& block) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (block[axis] < low[axis] || block[axis] >= low[axis] + size[axis]) return false;
    }
    return true;
  }
  /// Of a block that the lattice holds; z runs fastest.
  std::size_t index(const Index3& block) const {
    const auto at = [&](std::size_t axis) { return static_cast<std::size_t>(block[axis] - low[axis]); };
    return (at(0) * static_cast<std::size_t>(size[1]) + at(1)) * static_cast<std::size_t>(size[2]) + at(2);
  }
  Index3 block(std::size_t index) const {
    const auto y = static_cast<std::size_t>(size[1]);
    const auto z = static_cast<std::size_t>(size[2]);
    return {low[0] + static_cast<int>(index / (y * z)), low[1] + static_cast<int>(index / z % y),
            low[2] + static_cast<int>(index % z)};
  }
  /// How far apart in `index` neighbours along x, y and z are.
  std::array<std::ptrdiff_t, 3> strides() const {
    return {std::ptrdiff_t{size[1]} * size[2], std::ptrdiff_t{size[2]}, 1};
  }

  /// Of a voxel within its block; z runs fastest.
  static std::size_t offset(int x, int y, int z) {
    const int place = (x * kSide + y) * kSide + z;
    return static_cast<std::size_t>(place);
  }
  /// The centre of a block's first voxel.
  Vec3 corner_mm(const Index3& block) const { return kSide * voxel_mm * Vec3(block[0], block[1], block[2]); }
};

constexpr int kBlockSide = BlockLattice::kSide;

/// A block of what was drilled: at each voxel the distance to all that bits swept (mm, negative within, clamped to the
/// band) and its gradient. Most voxels lie beyond the band, where nothing asks for a gradient: only others are kept.
class HoleBlock {
 public:
  using Gradients = std::array<Eigen::Vector3f, BlockLattice::kVoxels>;

  /// All at one distance, without gradients.
  explicit HoleBlock(float at_mm) { distance_mm.fill(at_mm); }

  std::array<float, BlockLattice::kVoxels> distance_mm;

  /// Zero where none is kept.
  Eigen::Vector3f gradient(std::size_t offset) const {
    const std::uint64_t bits = kept_[offset / 64], bit = std::uint64_t{1} << offset % 64;
    if ((bits & bit) == 0) return Eigen::Vector3f::Zero();
    return gradients_[before_[offset / 64] + static_cast<std::size_t>(std::popcount(bits & (bit - 1)))];
  }
  /// All of them.
  Gradients gradients() const;
  /// Keeps those that are not zero.
  void set_gradients(const Gradients& gradients);
  /// The same distance throughout, and no gradient.
  bool is_even(float at_mm) const {
    return gradients_.empty() && std::ranges::all_of(distance_mm, [at_mm](float one) { return one == at_mm; });
  }

  std::size_t memory_bytes() const { return sizeof(*this) + gradients_.capacity() * sizeof(gradients_[0]); }

 private:
  std::array<std::uint64_t, BlockLattice::kVoxels / 64> kept_{};
  std::array<std::uint16_t, BlockLattice::kVoxels / 64> before_{};  ///< how many are kept before each 64 voxels
  std::vector<Eigen::Vector3f> gradients_;
};

/// Box around voxels of a block; empty where low > high.
struct BlockBox {
  static constexpr int kLast = BlockLattice::kSide - 1;
  std::array<int, 3> low{BlockLattice::kSide, BlockLattice::kSide, BlockLattice::kSide};
  std::array<int, 3> high{-1, -1, -1};

  static BlockBox whole() { return {{0, 0, 0}, {kLast, kLast, kLast}}; }
  bool empty() const { return high[0] < 0; }
  void extend(const std::array<int, 3>& voxel);
  void extend(const BlockBox& box);
};

/// What changed in a block.
struct BlockChange {
  BlockBox values;  ///< voxels whose distance to the hole changed
  BlockBox signs;   ///< voxels that were bone and are not, or the other way
};

}  // namespace spinaltap::detail
