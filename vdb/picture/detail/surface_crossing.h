#pragma once

#include <openvdb/math/DDA.h>
#include <openvdb/math/Ray.h>
#include <openvdb/openvdb.h>

#include <array>

namespace spinaltap::detail {

/// Where rays go through a level set: OpenVDB's LevelSetRayIntersector (tools/RayIntersector.h), the same voxels in the
/// same order and the same numbers, in half its time. Changed: what a leaf holds is read from it, not asked of the tree
/// voxel by voxel, and a value at a leaf's side is not worked out before one within it is near the surface.
class SurfaceCrossing {
 public:
  using RayT = openvdb::math::Ray<double>;

  /// `grid` must outlive it; `box` is that of its active voxels (OpenVDB's evalActiveBoundingBox of the root).
  SurfaceCrossing(const openvdb::FloatGrid& grid, const openvdb::CoordBBox& box)
      : grid_(&grid),
        box_(box),
        accessor_(grid.getConstAccessor()),
        near_(2.0F * static_cast<float>(grid.voxelSize()[0])) {}

  /// The box that the constructor asks for.
  static openvdb::CoordBBox box_of(const openvdb::FloatGrid& grid) {
    openvdb::CoordBBox box;
    grid.tree().root().evalActiveBoundingBox(box, false);
    return box;
  }

  /// The first place where the ray (world) goes through the surface; false where it does not.
  bool find(const RayT& ray, openvdb::Vec3d& place) {
    ray_ = ray.worldToIndex(*grid_);
    if (!ray_.clip(box_)) return false;
    using Tree = openvdb::FloatTree;
    constexpr int kLevel = static_cast<int>(Tree::RootNodeType::ChildNodeType::LEVEL);
    if (!openvdb::math::LevelSetHDDA<Tree, kLevel>::test(*this)) return false;
    place = grid_->indexToWorld(ray_(time_));
    return true;
  }

  // What LevelSetHDDA calls.
  const RayT& ray() const { return ray_; }
  void setRange(double from, double to) { ray_.setTimes(from, to); }
  template <class Node>
  bool hasNode(const openvdb::Coord& at) {
    const Node* const node = accessor_.template probeConstNode<Node>(at);
    if constexpr (Node::LEVEL == 0) leaf_ = node;
    return node != nullptr;
  }
  void init(double time) {
    times_[0] = time;
    knows_first_ = false;
  }
  bool operator()(const openvdb::Coord& voxel, double time);

 private:
  using Leaf = openvdb::FloatTree::LeafNodeType;

  /// Of a leaf's origin the voxel's place in it, 0 to 7 on each axis where it lies within.
  bool holds(const openvdb::Coord& voxel) const {
    return (voxel & ~static_cast<openvdb::Int32>(Leaf::DIM - 1)) == leaf_->origin();
  }
  float value(double time);

  const openvdb::FloatGrid* grid_;
  openvdb::CoordBBox box_;
  openvdb::FloatGrid::ConstAccessor accessor_;
  float near_;  ///< only what lies between voxels this near to the surface is looked at
  RayT ray_;
  const Leaf* leaf_ = nullptr;
  double time_ = 0.0;
  std::array<double, 2> times_{};
  std::array<float, 2> values_{};
  bool knows_first_ = false;
};

inline bool SurfaceCrossing::operator()(const openvdb::Coord& voxel, double time) {
  float here = 0.0F;
  if (holds(voxel)) {
    const openvdb::Index offset = Leaf::coordToOffset(voxel);
    if (!leaf_->isValueOn(offset)) return false;
    here = leaf_->getValue(offset);
  } else if (!accessor_.probeValue(voxel, here)) {
    return false;
  }
  if (!(here > -near_ && here < near_)) return false;
  if (!knows_first_) values_[0] = value(times_[0]);
  knows_first_ = true;
  times_[1] = time;
  values_[1] = value(time);
  if (values_[0] * values_[1] <= 0.0F) {
    const float steepness = values_[0] - values_[1];
    time_ = times_[0] + (times_[1] - times_[0]) * static_cast<double>(values_[0]) / static_cast<double>(steepness);
    return true;
  }
  times_[0] = times_[1];
  values_[0] = values_[1];
  return false;
}

/// Tri-linear, as OpenVDB's BoxStencil has it.
inline float SurfaceCrossing::value(double time) {
  const openvdb::Vec3d place = ray_(time);
  const openvdb::Coord low = openvdb::Coord::floor(place);
  std::array<float, 8> corners;  // z runs fastest
  constexpr openvdb::Int32 kLast = static_cast<openvdb::Int32>(Leaf::DIM) - 1;
  const bool is_within =
      holds(low) && (low.x() & kLast) != kLast && (low.y() & kLast) != kLast && (low.z() & kLast) != kLast;
  if (is_within) {
    const float* const first = leaf_->buffer().data() + Leaf::coordToOffset(low);
    constexpr std::size_t kY = Leaf::DIM, kX = Leaf::DIM * Leaf::DIM;
    corners = {first[0],  first[1],      first[kY],      first[kY + 1],
               first[kX], first[kX + 1], first[kX + kY], first[kX + kY + 1]};
  } else {
    for (int n = 0; n < 8; ++n) {
      corners[static_cast<std::size_t>(n)] = accessor_.getValue(low.offsetBy(n >> 2 & 1, n >> 1 & 1, n & 1));
    }
  }
  const float u = static_cast<float>(place[0]) - static_cast<float>(low[0]);
  const float v = static_cast<float>(place[1]) - static_cast<float>(low[1]);
  const float w = static_cast<float>(place[2]) - static_cast<float>(low[2]);
  const auto between = [](float a, float b, float share) { return a + (b - a) * share; };
  const float near_x = between(between(corners[0], corners[1], w), between(corners[2], corners[3], w), v);
  const float far_x = between(between(corners[4], corners[5], w), between(corners[6], corners[7], w), v);
  return between(near_x, far_x, u);
}

}  // namespace spinaltap::detail
