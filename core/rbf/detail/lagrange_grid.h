#pragma once

#include <vector>

#include "core/base/geometry.h"
#include "core/rbf/detail/simd_kernels.h"

namespace spinaltap::detail {

/// Even grids of order^3 nodes over a box, and the polynomials through them (Lagrange), for the far field.
class LagrangeGrid {
 public:
  /// `order` nodes along each edge, those at the ends included.
  explicit LagrangeGrid(int order);

  int order() const { return order_; }
  std::size_t node_count() const {
    const auto size = static_cast<std::size_t>(order_);
    return size * size * size;
  }
  /// Reciprocal of each basis polynomial's product at its own node.
  const double* inverse() const { return inverse_.data(); }
  /// Node k of the box -1..1.
  double node(int k) const { return -1.0 + 2.0 * k / (order_ - 1); }

  /// The order_ basis polynomials at t (-1..1).
  void basis(double t, double* out) const;

  /// Adds a source's weight at `place` (-1..1 along each axis) to the nodes (x fastest).
  void spread(const Vec3& place, double weight, double* nodes) const;

  /// Adds a child's nodes to its parent's; `octant`: bit 0, 1, 2 set where the child is the upper one in x, y, z.
  void child_to_parent(int octant, const double* child, double* parent) const;
  /// Adds the parent's polynomial at a child's nodes to them.
  void parent_to_child(int octant, const double* parent, double* child) const;

 private:
  int order_;
  std::vector<double> inverse_;
  /// half_[h][p * order + c]: the parent's basis polynomial p at the child's node c, h the half that the child is.
  std::vector<double> half_[2];
};

}  // namespace spinaltap::detail
