#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "core/tool/drill_bit.h"
#include "mesh/mesh_quality.h"
#include "mesh/remaining_mesh.h"
#include "tests/support/analytic_bodies.h"
#include "vdb/remaining/remaining_surface.h"

namespace spinaltap::test {

/// Bone to drill: away from the origin, askew to the voxels.
inline const Ball kDrilledBall{Vec3(3.1, -2.3, 105.7), 9.0};

/// A direction to drill it in, askew too.
inline const Vec3 kAslant = Vec3(0.4, -0.2, -1.0).normalized();

inline const BoneModel& ball_to_drill() {
  static const BoneModel bone = bake_ball(kDrilledBall, 0.25);
  return bone;
}

inline DrillBit paper_drill() { return {3.0, 50.0, 5.0}; }
inline DrillBit ball_burr() { return {4.0, 30.0, 1.0, BitShape::round_burr, 0.0, 2.0}; }
inline DrillBit cone_burr() { return {3.6, 30.0, 4.0, BitShape::conical_burr, 1.0, 2.0}; }

inline TriangleMesh joined(const RemainingSurface& surface) { return join_blocks(surface.blocks()); }

/// The triangles by the positions of their corners, each from its least corner on, sorted: what two meshes must share
/// to be equal as sets.
inline std::vector<std::array<std::array<float, 3>, 3>> triangle_set(const TriangleMesh& mesh) {
  std::vector<std::array<std::array<float, 3>, 3>> set;
  for (const auto& triangle : mesh.triangles) {
    std::array<std::array<float, 3>, 3> corners{};
    for (std::size_t n = 0; n < 3; ++n) {
      const Eigen::Vector3f& p = mesh.vertices_mm[triangle[n]];
      corners[n] = {p.x(), p.y(), p.z()};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    set.push_back(corners);
  }
  std::sort(set.begin(), set.end());
  return set;
}

/// Pairs of neighbouring voxels of which one is bone and one is not, in the whole grid.
inline std::size_t cut_edge_count(const RemainingBone& bone) {
  const auto low = bone.first_voxel();
  const auto high = bone.last_voxel();
  std::size_t count = 0;
  for (int x = low[0]; x < high[0]; ++x) {
    for (int y = low[1]; y < high[1]; ++y) {
      for (int z = low[2]; z < high[2]; ++z) {
        const bool own = bone.value_mm({x, y, z}) < 0.0F;
        count += own != (bone.value_mm({x + 1, y, z}) < 0.0F) ? 1U : 0U;
        count += own != (bone.value_mm({x, y + 1, z}) < 0.0F) ? 1U : 0U;
        count += own != (bone.value_mm({x, y, z + 1}) < 0.0F) ? 1U : 0U;
      }
    }
  }
  return count;
}

/// What the voxels that are bone stand for.
inline double bone_voxel_volume_mm3(const RemainingBone& bone) {
  const auto low = bone.first_voxel();
  const auto high = bone.last_voxel();
  std::size_t count = 0;
  for (int x = low[0]; x <= high[0]; ++x) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int z = low[2]; z <= high[2]; ++z) count += bone.value_mm({x, y, z}) < 0.0F ? 1U : 0U;
    }
  }
  return static_cast<double>(count) * std::pow(bone.voxel_mm(), 3);
}

/// Numbers in a row from a seed.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : seed_(seed) {}
  double operator()(double low, double high) { return low + (high - low) * random_uniform(seed_, next_++); }
  int below(int count) { return std::min(count - 1, static_cast<int>((*this)(0.0, count))); }
  Vec3 direction() {
    const double z = (*this)(-1.0, 1.0);
    const double turn = (*this)(0.0, 2.0 * std::numbers::pi);
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(turn), r * std::sin(turn), z};
  }
  /// Unit, within `angle_rad` or so of `axis`.
  Vec3 near(const Vec3& axis, double angle_rad) { return (axis + angle_rad * direction()).normalized(); }

 private:
  std::uint64_t seed_;
  std::uint64_t next_ = 0;
};

}  // namespace spinaltap::test
