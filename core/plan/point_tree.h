#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap {

/// Finds the nearest of many points: a k-d tree over points that do not change. Safe to ask from many threads.
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
  /// The same, sooner where points_mm()[guess] is about as near. Of several points at one distance it may find another.
  Nearest nearest(const Vec3& p_mm, std::size_t guess) const;

 private:
  struct Tree;
  std::unique_ptr<const Tree> tree_;
};

}  // namespace spinaltap
