#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/error.h"
#include "core/engine/swept_engine.h"
#include "core/points/hu_byte.h"
#include "core/points/material.h"
#include "vdb/engine/detail/word_kernels.h"

namespace spinaltap::detail {

/// 8 x 8 x 8 voxels of a VoxelBone that an engine takes from.
struct OccupiedLeaf {
  std::uint64_t* words = nullptr;  ///< of occupied bits, one for each x
  const std::uint8_t* hu = nullptr;
  std::array<std::int32_t, 3> origin{};  ///< voxels from the engine's middle
  std::uint32_t occupied = 0;
};

/// Which voxel a bit of a leaf's 512 is, in voxels from the engine's middle.
inline Vec3 voxel_of(const OccupiedLeaf& leaf, std::size_t bit) noexcept {
  const auto at = static_cast<std::int32_t>(bit);
  return Eigen::Vector3i(leaf.origin[0] + at / 64, leaf.origin[1] + at / 8 % 8, leaf.origin[2] + at % 8).cast<double>();
}

/// Voxels as a tool sees them, in whichever way it is turned.
struct AxisView {
  Mat3 rows = Mat3::Zero();  ///< as SweptBit or SweptPlate have them
  WordOffsets offsets;

  /// Most steps turn little or not.
  void take(const Mat3& new_rows, double voxel_mm) noexcept {
    if (rows == new_rows) return;
    rows = new_rows;
    for (unsigned bit = 0; bit < 64; ++bit) {
      const unsigned y = bit / 8, z = bit % 8;
      for (unsigned n = 0; n < 3; ++n) {
        offsets.of_bits[n][bit] = static_cast<float>(voxel_mm * (rows(n, 1) * y + rows(n, 2) * z));
      }
    }
  }

  /// Where a leaf lies whose first voxel is `first_mm` from the tool's tip.
  LeafPlace place_of(const Vec3& first_mm, double voxel_mm) const noexcept {
    LeafPlace place;
    place.offsets = &offsets;
    const Vec3 seen_mm = rows * first_mm;
    for (unsigned n = 0; n < 3; ++n) {
      place.first[n] = static_cast<float>(seen_mm[n]);
      place.per_x[n] = static_cast<float>(rows(n, 0) * voxel_mm);
    }
    return place;
  }
};

/// What voxels count when they die, see Removal: places in voxels from the engine's middle.
class VoxelSums {
 public:
  /// Throws Error on a bad material.
  explicit VoxelSums(const Material& material) {
    check_material(material);
    const PressureTable pressures(material, hu_of_byte(0), hu_of_byte(255));
    for (unsigned n = 0; n < 256; ++n) pressure_[n] = pressures.units(hu_of_byte(static_cast<std::uint8_t>(n)));
  }
  /// Throws Error where the moment of so many voxels, no more than `places` from the middle, would not fit.
  void check_fit(std::int32_t places, std::size_t voxels) const {
    const double most = (1.0 + static_cast<double>(places)) * static_cast<double>(pressure_.back());
    if (!(most * static_cast<double>(voxels) < 0x1.0p62)) {
      fail("voxel engine: expected fewer voxels of less hard bone: their moment does not fit 64 bits");
    }
  }

  /// Voxels `dead` of word x of a leaf die; they must live.
  void kill(OccupiedLeaf& leaf, unsigned x, std::uint64_t dead, Removal& removal) const noexcept {
    if (dead == 0) return;
    leaf.words[x] &= ~dead;
    const auto count = static_cast<std::uint32_t>(std::popcount(dead));
    leaf.occupied -= count;
    removal.removed += count;
    removal.parts += count;
    std::int64_t bytes = 0, pressure = 0, along_y = 0, along_z = 0;
    const std::uint8_t* const hu = leaf.hu + std::size_t{x} * 64;
    for (std::uint64_t left = dead; left != 0; left &= left - 1) {
      const int bit = std::countr_zero(left);
      const std::uint8_t byte = hu[bit];
      bytes += byte;
      const std::int64_t units = pressure_[byte];
      pressure += units;
      along_y += units * (bit >> 3);
      along_z += units * (bit & 7);
    }
    removal.hu += kHuOfByteStep * bytes + std::int64_t{kLowestHuOfByte} * count;
    removal.pressure += pressure;
    removal.moment[0] += pressure * (leaf.origin[0] + static_cast<std::int32_t>(x));
    removal.moment[1] += pressure * leaf.origin[1] + along_y;
    removal.moment[2] += pressure * leaf.origin[2] + along_z;
    if (!removal.back.is_asked()) return;
    const std::int64_t first =
        removal.back.along(leaf.origin[0] + static_cast<std::int32_t>(x), leaf.origin[1], leaf.origin[2]);
    for (std::uint64_t left = dead; left != 0; left &= left - 1) {
      const int bit = std::countr_zero(left);
      const std::int64_t along = first + removal.back.back[1] * (bit >> 3) + removal.back.back[2] * (bit & 7);
      removal.pressure_back[removal.back.part(along)] += pressure_[hu[bit]];
    }
  }

 private:
  std::array<std::int64_t, 256> pressure_{};
};

}  // namespace spinaltap::detail
