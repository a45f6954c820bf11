#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap {

/// Finds the nearest of many points, and those along a line: a k-d tree over points that do not change. Safe to ask
/// from many threads.
class PointTree {
 public:
  /// Throws Error when a point is not finite.
  explicit PointTree(std::vector<Vec3> points_mm);
  PointTree(PointTree&&) noexcept;
  PointTree& operator=(PointTree&&) noexcept;
  ~PointTree();

  const std::vector<Vec3>& points_mm() const;

  struct Nearest {
    std::size_t index = std::numeric_limits<std::size_t>::max();  ///< max(): there is no point
    double distance_mm = std::numeric_limits<double>::infinity();
  };
  /// Nothing for positions that are not finite.
  Nearest nearest(const Vec3& p_mm) const;
  /// The same, also of several points at one distance, and sooner where points_mm()[guess] is about as near.
  Nearest nearest(const Vec3& p_mm, std::size_t guess) const;

  /// Points that are neighbours, and a ball around them.
  struct Group {
    Vec3 middle_mm;
    double radius_mm;
    std::span<const std::uint32_t> points;  ///< places in points_mm()
  };
  /// All points, each in one group: for searches that can pass over most of them.
  const std::vector<Group>& groups() const;

  /// A stretch of a straight line and what lies around it: a cylinder.
  struct Stretch {
    Vec3 origin_mm, direction;  ///< direction: unit
    double from_mm, to_mm;      ///< along it, from the origin
    double reach_mm;            ///< to all sides
  };
  /// Places in points_mm() of all that lie in the stretch, and of some that lie near it, in an order that depends on
  /// the points alone.
  std::vector<std::size_t> along(const Stretch& stretch) const;

 private:
  struct Tree;
  std::unique_ptr<const Tree> tree_;
};

}  // namespace spinaltap
