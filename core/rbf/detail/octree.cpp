#include "core/rbf/detail/octree.h"

#include <algorithm>
#include <numeric>

namespace spinaltap::detail {
namespace {

int octant_of(const Vec3& p, const Vec3& centre) {
  return (p.x() >= centre.x() ? 1 : 0) + (p.y() >= centre.y() ? 2 : 0) + (p.z() >= centre.z() ? 4 : 0);
}

}  // namespace

Octree::Octree(std::span<const Vec3> points_mm, std::size_t leaf_size, std::size_t beside_size) {
  constexpr double kPadding = 1.1;  // fields are asked a little beyond their centres too
  const Box3 bounds = bounds_of(points_mm);
  size_mm_ = std::max(bounds.sizes().maxCoeff() * kPadding, 1e-9);
  low_mm_ = bounds.center() - Vec3::Constant(0.5 * size_mm_);
  sorted_.resize(points_mm.size());
  std::iota(sorted_.begin(), sorted_.end(), 0U);
  boxes_.push_back({});
  boxes_.back().end = static_cast<std::uint32_t>(points_mm.size());

  std::vector<std::uint32_t> scratch(points_mm.size());
  level_begin_ = {0};
  for (std::uint32_t begin = 0; begin < boxes_.size();) {
    const auto end = static_cast<std::uint32_t>(boxes_.size());
    level_begin_.push_back(end);
    const std::vector<bool> is_beside = beside_crowds(begin, beside_size);
    for (std::uint32_t b = begin; b < end; ++b) {
      const Box box = boxes_[b];
      if ((box.count() <= leaf_size && !is_beside[b - begin]) || box.level == kDeepest) continue;
      const Vec3 centre = centre_mm(box);
      std::array<std::uint32_t, 9> start{};
      for (std::uint32_t i = box.begin; i < box.end; ++i) {
        ++start[static_cast<std::size_t>(octant_of(points_mm[sorted_[i]], centre)) + 1];
      }
      std::partial_sum(start.begin(), start.end(), start.begin());
      std::array<std::uint32_t, 9> next = start;
      for (std::uint32_t i = box.begin; i < box.end; ++i) {
        const auto octant = static_cast<std::size_t>(octant_of(points_mm[sorted_[i]], centre));
        scratch[box.begin + next[octant]++] = sorted_[i];
      }
      std::copy(scratch.begin() + box.begin, scratch.begin() + box.end, sorted_.begin() + box.begin);
      boxes_[b].first_child = static_cast<std::uint32_t>(boxes_.size());
      for (std::size_t octant = 0; octant < 8; ++octant) {
        Box child;
        child.level = box.level + 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          child.at[axis] = 2 * box.at[axis] + static_cast<int>((octant >> axis) & 1U);
        }
        child.parent = b;
        child.begin = box.begin + start[octant];
        child.end = box.begin + start[octant + 1];
        boxes_.push_back(child);
      }
    }
    begin = end;
  }
}

std::vector<bool> Octree::beside_crowds(std::uint32_t begin, std::size_t beside_size) const {
  std::vector<bool> is_beside(boxes_.size() - begin, false);
  for (std::size_t b = begin; b < boxes_.size(); ++b) {
    const Box& box = boxes_[b];
    if (box.count() <= beside_size) continue;
    for (int n = 0; n < 27; ++n) {
      // Every neighbour within the root exists: its parent is the crowded box's own or touches it, and was divided.
      const std::uint32_t other =
          box_at(box.level, {box.at[0] + n % 3 - 1, box.at[1] + n / 3 % 3 - 1, box.at[2] + n / 9 - 1});
      if (other != kNone) is_beside[other - begin] = true;
    }
  }
  return is_beside;
}

std::uint32_t Octree::box_at(int level, const std::array<int, 3>& at) const {
  for (const int a : at) {
    if (a < 0 || a >= 1 << level) return kNone;
  }
  std::uint32_t box = 0;
  for (int shift = level; shift-- > 0;) {
    if (boxes_[box].is_leaf()) return kNone;
    std::uint32_t octant = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      octant |= ((static_cast<std::uint32_t>(at[axis]) >> shift) & 1U) << axis;
    box = boxes_[box].first_child + octant;
  }
  return box;
}

Vec3 Octree::centre_mm(const Box& box) const {
  const double half_mm = half_width_mm(box);
  return low_mm_ + half_mm * Vec3(2 * box.at[0] + 1, 2 * box.at[1] + 1, 2 * box.at[2] + 1);
}

bool Octree::contains(const Vec3& p_mm) const {
  const Vec3 from_low = p_mm - low_mm_;
  return (from_low.array() >= 0.0).all() && (from_low.array() <= size_mm_).all();
}

std::uint32_t Octree::leaf_at(const Vec3& p_mm) const {
  std::uint32_t box = 0;
  while (!boxes_[box].is_leaf()) {
    box = boxes_[box].first_child + static_cast<std::uint32_t>(octant_of(p_mm, centre_mm(boxes_[box])));
  }
  return box;
}

bool are_adjacent(const Octree::Box& a, const Octree::Box& b) {
  const int level = std::max(a.level, b.level);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int a_low = a.at[axis] << (level - a.level);
    const int a_high = (a.at[axis] + 1) << (level - a.level);
    const int b_low = b.at[axis] << (level - b.level);
    const int b_high = (b.at[axis] + 1) << (level - b.level);
    if (a_low > b_high || b_low > a_high) return false;
  }
  return true;
}

}  // namespace spinaltap::detail
