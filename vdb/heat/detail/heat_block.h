#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace spinaltap::detail {

inline constexpr int kHeatSide = 8;
inline constexpr std::size_t kHeatVoxels = 512;

using HeatIndex = std::array<int, 3>;

enum class HeatVoxel : std::uint8_t { air, bone, drilled };

/// Voxels in OpenVDB's order of a leaf: x slowest.
struct HeatBlock {
  HeatIndex origin{};
  std::array<std::array<double, kHeatVoxels>, 2> rise_k{};  ///< now and next, by turns
  std::array<float, kHeatVoxels> conductivity{};
  std::array<double, kHeatVoxels> per_capacity{};  ///< mm³ K / J
  /// Conductivity between a voxel and the next one along x, y, z.
  std::array<std::array<float, kHeatVoxels>, 3> face{};
  std::array<float, kHeatVoxels> wall{};  ///< share of a face that looks into the hole
  std::array<float, kHeatVoxels> max_k{};
  std::array<std::array<float, kHeatVoxels>, 2> hot_s{};
  std::array<HeatVoxel, kHeatVoxels> voxel{};
  std::array<HeatBlock*, 6> near{};  ///< towards -x, +x, -y, +y, -z, +z; null: none
  std::array<bool, 6> is_seen{};     ///< heat has come to that side
  double max_rate_per_s = 0.0;
  double water_k_mm3_s = 0.0;
  bool is_stale = true;  ///< faces are to be worked out
};

inline constexpr std::array<std::size_t, 3> kHeatStride{64, 8, 1};

inline std::size_t heat_index_in(const HeatIndex& voxel) {
  const int place = (voxel[0] & 7) * 64 + (voxel[1] & 7) * 8 + (voxel[2] & 7);
  return static_cast<std::size_t>(place);
}
inline HeatIndex heat_origin_of(const HeatIndex& voxel) { return {voxel[0] & ~7, voxel[1] & ~7, voxel[2] & ~7}; }
inline HeatIndex heat_place_in(std::size_t n) {
  return {static_cast<int>(n / 64), static_cast<int>(n / 8 % 8), static_cast<int>(n % 8)};
}

/// Calls for all voxels of a layer across an axis.
template <typename Call>
void for_layer(std::size_t axis, std::size_t layer, const Call& call) {
  const std::size_t first = layer * kHeatStride[axis];
  const std::size_t outer = axis == 0 ? kHeatStride[1] : kHeatStride[0];
  const std::size_t inner = axis == 2 ? kHeatStride[1] : kHeatStride[2];
  for (std::size_t i = 0; i < kHeatSide; ++i) {
    for (std::size_t j = 0; j < kHeatSide; ++j) call(first + i * outer + j * inner);
  }
}

/// Adds what flows between a block's own voxels along an axis: from the one before first, then to the one behind.
void flow_within(const std::array<float, kHeatVoxels>& face, const std::array<double, kHeatVoxels>& now,
                 std::size_t stride, std::array<double, kHeatVoxels>& flow);

}  // namespace spinaltap::detail
