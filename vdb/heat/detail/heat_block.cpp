#include "vdb/heat/detail/heat_block.h"

namespace spinaltap::detail {

void flow_within(const std::array<float, kHeatVoxels>& face, const std::array<double, kHeatVoxels>& now,
                 std::size_t stride, std::array<double, kHeatVoxels>& flow) {
  std::array<double, kHeatVoxels> through;
  for (std::size_t n = 0; n + stride < kHeatVoxels; ++n) {
    through[n] = static_cast<double>(face[n]) * (now[n + stride] - now[n]);
  }
  // Voxels that lie one behind the other have a row of `stride` beside them, which is one loop.
  for (std::size_t row = 0; row < kHeatVoxels; row += kHeatSide * stride) {
    for (std::size_t n = row + stride; n < row + kHeatSide * stride; ++n) flow[n] -= through[n - stride];
    for (std::size_t n = row; n < row + (kHeatSide - 1) * stride; ++n) flow[n] += through[n];
  }
}

}  // namespace spinaltap::detail
