#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap::detail {

/// An adaptive octree over points. A box with more than `leaf_size` of them has eight children, empty ones too, so that
/// every place of the root cube lies in exactly one leaf. With a `beside_size` (`leaf_size` or more) the boxes that
/// touch one with more points than that are divided as it is: places without points are then near few points as well.
class Octree {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffU;
  static constexpr int kDeepest = 20;

  struct Box {
    int level = 0;
    std::array<int, 3> at{};  ///< position among the boxes of its level
    std::uint32_t parent = kNone;
    std::uint32_t first_child = kNone;  ///< of eight; kNone for a leaf
    std::uint32_t begin = 0;            ///< its points are sorted()[begin..end)
    std::uint32_t end = 0;
    bool is_leaf() const { return first_child == kNone; }
    std::uint32_t count() const { return end - begin; }
  };

  /// Points must be finite and at least one.
  Octree(std::span<const Vec3> points_mm, std::size_t leaf_size, std::size_t beside_size = kNone);

  /// Level by level, the root first.
  const std::vector<Box>& boxes() const { return boxes_; }
  /// Indices into the points, box by box.
  const std::vector<std::uint32_t>& sorted() const { return sorted_; }
  /// The first box of each level, and one past the last level's.
  const std::vector<std::uint32_t>& level_begin() const { return level_begin_; }

  double half_width_mm(const Box& box) const { return 0.5 * size_mm_ / static_cast<double>(1 << box.level); }
  Vec3 centre_mm(const Box& box) const;

  bool contains(const Vec3& p_mm) const;
  /// The leaf that holds a place of the root cube.
  std::uint32_t leaf_at(const Vec3& p_mm) const;

 private:
  /// Which of the last level's boxes, from `begin` on, touch one with more than `beside_size` points.
  std::vector<bool> beside_crowds(std::uint32_t begin, std::size_t beside_size) const;
  /// The box at a position among those of a level; kNone where the tree does not go so deep.
  std::uint32_t box_at(int level, const std::array<int, 3>& at) const;

  Vec3 low_mm_;
  double size_mm_ = 0.0;
  std::vector<Box> boxes_;
  std::vector<std::uint32_t> sorted_;
  std::vector<std::uint32_t> level_begin_;
};

/// Whether two boxes, of any levels, touch or overlap.
bool are_adjacent(const Octree::Box& a, const Octree::Box& b);

}  // namespace spinaltap::detail
