#include "apps/spinaltap-planner/slices/hole_walls.h"

namespace spinaltap {

void HoleWalls::update(std::span<const SurfaceUpdate> updates) {
  for (const SurfaceUpdate& changed : updates) {
    if (changed.surface != nullptr && changed.surface->wall_begin < changed.surface->triangles.size()) {
      blocks_[changed.block] = changed.surface;
    } else {
      blocks_.erase(changed.block);
    }
  }
}

std::vector<std::array<Eigen::Vector2d, 2>> HoleWalls::section(const SliceFrame& frame) const {
  std::vector<std::array<Eigen::Vector2d, 2>> pieces;
  std::vector<Vec3> pixels;  // and the depth behind the plane
  for (const auto& [place, block] : blocks_) {
    pixels.clear();
    for (const Eigen::Vector3f& vertex : block->vertices_mm) pixels.push_back(frame.to_pixel(vertex.cast<double>()));
    for (std::size_t n = block->wall_begin; n < block->triangles.size(); ++n) {
      std::array<Eigen::Vector2d, 2> piece;
      std::size_t ends = 0;
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const Vec3& a = pixels[block->triangles[n][corner]];
        const Vec3& b = pixels[block->triangles[n][(corner + 1) % 3]];
        // A corner on the plane counts as behind it, so that an odd number of crossings cannot be.
        if ((a.z() < 0.0) == (b.z() < 0.0)) continue;
        const double share = a.z() / (a.z() - b.z());
        piece[ends++] = a.head<2>() + share * (b - a).head<2>();
      }
      if (ends == 2) pieces.push_back(piece);
    }
  }
  return pieces;
}

}  // namespace spinaltap
