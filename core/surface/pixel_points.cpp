#include "core/surface/pixel_points.h"

namespace spinaltap {
namespace {

constexpr std::array<std::array<int, 2>, 4> kSteps{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};

bool is_bone(const BoneMask& mask, int i, int j, int k) { return mask.geometry.contains(i, j, k) && mask.at(i, j, k); }

bool is_surface(const BoneMask& mask, int i, int j, int k) {
  if (!is_bone(mask, i, j, k)) return false;
  for (const auto& step : kSteps) {
    if (!is_bone(mask, i + step[0], j + step[1], k)) return true;
  }
  return false;
}

}  // namespace

PixelPoints surface_pixels(const BoneMask& mask) {
  PixelPoints pixels;
  const auto& size = mask.geometry.size;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        if (!is_surface(mask, i, j, k)) continue;
        Vec3 outward = Vec3::Zero();
        for (const auto& step : kSteps) {
          if (is_bone(mask, i + step[0], j + step[1], k)) continue;
          outward += step[0] * mask.geometry.directions.col(0) + step[1] * mask.geometry.directions.col(1);
        }
        // Opposite steps cancel exactly, but for the rounding of the axes.
        constexpr double kNothing = 1e-9;
        pixels.voxels.push_back({i, j, k});
        pixels.outward.emplace_back(outward.norm() > kNothing ? outward : Vec3(Vec3::Zero()));
      }
    }
  }
  return pixels;
}

PixelNeighbours neighbour_pixels(const BoneMask& mask, const PixelPoints& pixels) {
  PixelNeighbours neighbours;
  std::vector<bool> taken(mask.geometry.voxel_count(), false);
  for (std::size_t at = 0; at < pixels.voxels.size(); ++at) {
    const auto [i, j, k] = pixels.voxels[at];
    for (const auto& step : kSteps) {
      const std::array<int, 3> next{i + step[0], j + step[1], k};
      if (!mask.geometry.contains(next[0], next[1], k) || is_surface(mask, next[0], next[1], k)) continue;
      const std::size_t offset = mask.geometry.offset(next[0], next[1], k);
      if (taken[offset]) continue;
      taken[offset] = true;
      neighbours.voxels.push_back(next);
      neighbours.of.push_back(at);
      neighbours.is_inside.push_back(mask.at(next[0], next[1], k));
    }
  }
  return neighbours;
}

}  // namespace spinaltap
