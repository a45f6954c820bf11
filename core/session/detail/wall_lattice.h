#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/plan/wall_distance.h"
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

  /// Places are path-local: the origin at the path's entry, z along it.
  const PathFrame& frame() const { return frame_; }

  /// As WallDistance has it, mm: positive in the bone, negative beyond the wall. Infinite outside the lattice and where
  /// there is no such wall.
  double distance_mm(const Vec3& p_path, WallKind wall) const noexcept;

  /// To the bone's surface, mm: positive in the bone. Infinite outside the lattice.
  double inside_mm(const Vec3& p_path) const noexcept;

  /// How far a place lies outside the lattice, at least; 0 within it, where what is infinite has no such wall.
  double outside_mm(const Vec3& p_path) const noexcept {
    const Vec3 high_mm = low_mm_ + (count_ - 1).cast<double>().matrix() / per_mm_;
    return std::max(0.0, (low_mm_ - p_path).cwiseMax(p_path - high_mm).maxCoeff());
  }

  std::size_t memory_bytes() const { return nodes_.size() * sizeof(Node); }

 private:
  /// To the bone's surface (positive in it), to the outer wall and to the canal's (never negative), mm; 0.
  using Node = Eigen::Array4f;

  /// Tri-linear; nothing outside the lattice.
  bool node_at(const Vec3& p_path, Node& node) const noexcept;

  PathFrame frame_;
  double per_mm_;                                  ///< nodes
  Vec3 low_mm_;                                    ///< of node 0, path-local
  Eigen::Array3i count_ = Eigen::Array3i::Zero();  ///< along x, y, z
  Eigen::Array3d last_ = Eigen::Array3d::Zero();   ///< the last's number
  std::vector<Node> nodes_;                        ///< z runs fastest: a bit's axis stays on few cache lines
};

}  // namespace spinaltap
