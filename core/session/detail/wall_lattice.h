#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "core/anatomy/wall_distance.h"
#include "core/base/progress.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// Which of a vertebra's walls.
enum class WallKind { outer, canal };

/// Distances to both walls on a lattice along a path, tri-linear between its nodes, in single precision. What is kept
/// is smooth where the walls are: to the bone's surface with a sign, and to either wall without one. A wall's own
/// signed distance jumps where another becomes the nearer one, and would not bear interpolation.
class WallLattice {
 public:
  /// Nodes `spacing_mm` apart within `reach_mm` of the path's line, along it from `behind_mm` before its entry to
  /// `beyond_mm` past its target. Asks `walls` of each bone at each of them, from many threads. In bone is what lies in
  /// one of them.
  WallLattice(std::span<const WallDistance* const> walls, const DrillPath& path, double spacing_mm, double reach_mm,
              double behind_mm, double beyond_mm, const Progress& progress);

  /// To the bone's surface (positive in it), to the outer wall and to the canal's (never negative), mm; 0.
  using Node = Eigen::Array4f;
  static constexpr float kFarthestMm = 1e6F;  ///< what is further is no distance

  /// Places are path-local: the origin at the path's entry, z along it.
  const PathFrame& frame() const { return frame_; }

  /// As WallDistance has it, mm: positive in the bone, negative beyond the wall. Infinite outside the lattice and where
  /// there is no such wall.
  double distance_mm(const Vec3& p_path, WallKind wall) const noexcept;

  /// Whether a place lies in the lattice.
  bool holds(const Vec3& p_path) const noexcept;
  /// Tri-linear, at a place that it holds.
  Node node_within(const Vec3& p_path) const noexcept;
  /// distance_mm() by what is at a place.
  template <WallKind wall>
  static double distance_of(const Node& node) noexcept;

  /// To the bone's surface, mm: positive in the bone. Infinite outside the lattice.
  double inside_mm(const Vec3& p_path) const noexcept;

  /// How far a place lies outside the lattice, at least; 0 within it, where what is infinite has no such wall.
  double outside_mm(const Vec3& p_path) const noexcept {
    const Vec3 high_mm = low_mm_ + (count_ - 1).cast<double>().matrix() / per_mm_;
    return std::max(0.0, (low_mm_ - p_path).cwiseMax(p_path - high_mm).maxCoeff());
  }

  std::size_t memory_bytes() const { return nodes_.size() * sizeof(Node); }

 private:
  PathFrame frame_;
  double per_mm_;                                  ///< nodes
  Vec3 low_mm_;                                    ///< of node 0, path-local
  Eigen::Array3i count_ = Eigen::Array3i::Zero();  ///< along x, y, z
  Eigen::Array3d last_ = Eigen::Array3d::Zero();   ///< the last's number
  std::ptrdiff_t next_x_ = 0, next_y_ = 0;         ///< nodes from one to the next along x, y
  std::vector<Node> nodes_;                        ///< z runs fastest: a bit's axis stays on few cache lines
};

inline WallLattice::Node WallLattice::node_within(const Vec3& p_path) const noexcept {
  const double x = (p_path.x() - low_mm_.x()) * per_mm_;
  const double y = (p_path.y() - low_mm_.y()) * per_mm_;
  const double z = (p_path.z() - low_mm_.z()) * per_mm_;
  const int i = static_cast<int>(x), j = static_cast<int>(y), k = static_cast<int>(z);
  const auto share_x = static_cast<float>(x - i), share_y = static_cast<float>(y - j),
             share_z = static_cast<float>(z - k);
  const std::ptrdiff_t next_y = next_y_, next_x = next_x_;
  const Node* const c00 = nodes_.data() + i * next_x + j * next_y + k;
  const auto along_z = [&](const Node* of) -> Node { return of[0] + share_z * (of[1] - of[0]); };
  const auto along_y = [&](const Node* of) -> Node {
    const Node at = along_z(of);
    return at + share_y * (along_z(of + next_y) - at);
  };
  const Node low = along_y(c00);
  return low + share_x * (along_y(c00 + next_x) - low);
}

inline bool WallLattice::holds(const Vec3& p_path) const noexcept {
  const double x = (p_path.x() - low_mm_.x()) * per_mm_;
  const double y = (p_path.y() - low_mm_.y()) * per_mm_;
  const double z = (p_path.z() - low_mm_.z()) * per_mm_;
  // Also what is not a number has no distance.
  return x >= 0.0 && y >= 0.0 && z >= 0.0 && x < last_.x() && y < last_.y() && z < last_.z();
}

template <WallKind wall>
inline double WallLattice::distance_of(const Node& node) noexcept {
  // The nearer wall is the bone's surface; the other one is ahead, wherever the place is.
  const bool is_canal_nearer = node[2] < node[1];
  const bool is_nearer = is_canal_nearer == (wall == WallKind::canal);
  const float distance_mm = is_nearer ? node[0] : node[wall == WallKind::canal ? 2 : 1];
  return distance_mm < kFarthestMm ? static_cast<double>(distance_mm) : std::numeric_limits<double>::infinity();
}

inline double WallLattice::distance_mm(const Vec3& p_path, WallKind wall) const noexcept {
  if (!holds(p_path)) return std::numeric_limits<double>::infinity();
  const Node node = node_within(p_path);
  return wall == WallKind::canal ? distance_of<WallKind::canal>(node) : distance_of<WallKind::outer>(node);
}

inline double WallLattice::inside_mm(const Vec3& p_path) const noexcept {
  constexpr double kNowhereMm = std::numeric_limits<double>::infinity();
  if (!holds(p_path)) return kNowhereMm;
  const float inside_mm = node_within(p_path)[0];
  return inside_mm < kFarthestMm ? static_cast<double>(inside_mm) : kNowhereMm;
}

}  // namespace spinaltap
