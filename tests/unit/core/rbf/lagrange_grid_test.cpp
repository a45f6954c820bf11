#include "core/rbf/detail/lagrange_grid.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap::detail {
namespace {

constexpr std::uint64_t kLagrangeSeed = 53;

/// A polynomial of degree order - 1 in each of x, y and z, at most about 1 in the box.
class Polynomial {
 public:
  explicit Polynomial(int order) : order_(order) {}
  double along(int axis, double t) const {
    double sum = 0.0;
    double power = 1.0;
    for (int k = 0; k < order_; ++k, power *= t) {
      sum += power * random_normal(kLagrangeSeed + static_cast<std::uint64_t>(axis), static_cast<std::uint64_t>(k)) /
             order_;
    }
    return sum;
  }
  double operator()(const Vec3& p) const { return along(0, p.x()) * along(1, p.y()) * along(2, p.z()); }

 private:
  int order_;
};

Vec3 node_at(const LagrangeGrid& grid, std::size_t k) {
  const auto size = static_cast<std::size_t>(grid.order());
  return {grid.node(static_cast<int>(k % size)), grid.node(static_cast<int>(k / size % size)),
          grid.node(static_cast<int>(k / size / size))};
}

Vec3 in_parent(int octant, const Vec3& p) {
  return 0.5 * p + 0.5 * Vec3(octant & 1 ? 1.0 : -1.0, octant & 2 ? 1.0 : -1.0, octant & 4 ? 1.0 : -1.0);
}

// Even grids of 14 nodes blow rounding up by 100 (their Lebesgue constant) along each axis: 1e-16 becomes 1e-10 at
// worst. Polynomials through random numbers come nowhere near that.
constexpr double kRounding = 1e-11;

TEST(LagrangeGrid, ReproducesPolynomialsAlongALine) {
  SCOPED_TRACE(::testing::Message() << "seed " << kLagrangeSeed);
  for (int order = 3; order <= kMaxOrder; ++order) {
    const LagrangeGrid grid(order);
    const Polynomial polynomial(order);
    for (std::uint64_t n = 0; n < 50; ++n) {
      const double t = 2.0 * random_uniform(kLagrangeSeed, n) - 1.0;
      std::array<double, kMaxOrder> basis{};
      grid.basis(t, basis.data());
      double sum = 0.0;
      double ones = 0.0;
      for (int k = 0; k < order; ++k) {
        sum += basis[static_cast<std::size_t>(k)] * polynomial.along(0, grid.node(k));
        ones += basis[static_cast<std::size_t>(k)];
      }
      EXPECT_NEAR(sum, polynomial.along(0, t), kRounding) << "order " << order;
      EXPECT_NEAR(ones, 1.0, kRounding) << "order " << order;
    }
  }
}

TEST(LagrangeGrid, HasABasisThatIsOneAtItsNodeAndNoughtAtTheOthers) {
  for (int order = 3; order <= kMaxOrder; ++order) {
    const LagrangeGrid grid(order);
    EXPECT_EQ(grid.node(0), -1.0);
    EXPECT_EQ(grid.node(order - 1), 1.0);
    for (int at = 0; at < order; ++at) {
      std::array<double, kMaxOrder> basis{};
      grid.basis(grid.node(at), basis.data());
      for (int k = 0; k < order; ++k) {
        EXPECT_NEAR(basis[static_cast<std::size_t>(k)], k == at ? 1.0 : 0.0, k == at ? 1e-14 : 0.0);  // 26 roundings
      }
    }
  }
}

TEST(LagrangeGrid, SpreadsASourceSoThatPolynomialsSeeNoDifference) {
  SCOPED_TRACE(::testing::Message() << "seed " << kLagrangeSeed);
  for (int order = 3; order <= kMaxOrder; ++order) {
    const LagrangeGrid grid(order);
    const Polynomial polynomial(order);
    std::vector<double> nodes(grid.node_count(), 0.0);
    double expected = 0.0;
    for (std::uint64_t n = 0; n < 10; ++n) {
      const Vec3 place = test::random_place(kLagrangeSeed, n, 1.0);
      const double weight = random_normal(kLagrangeSeed + 5, n);
      grid.spread(place, weight, nodes.data());
      expected += weight * polynomial(place);
    }
    double found = 0.0;
    for (std::size_t k = 0; k < nodes.size(); ++k) found += nodes[k] * polynomial(node_at(grid, k));
    EXPECT_NEAR(found, expected, kRounding) << "order " << order;
  }
}

TEST(LagrangeGrid, HandsAChildsNodesToItsParentSoThatPolynomialsSeeNoDifference) {
  SCOPED_TRACE(::testing::Message() << "seed " << kLagrangeSeed);
  for (int order = 3; order <= kMaxOrder; ++order) {
    const LagrangeGrid grid(order);
    const Polynomial polynomial(order);
    std::vector<double> parent(grid.node_count(), 0.0);
    double expected = 0.0;
    for (int octant = 0; octant < 8; ++octant) {
      const std::vector<double> child =
          test::random_weights(grid.node_count(), kLagrangeSeed + static_cast<std::uint64_t>(octant));
      grid.child_to_parent(octant, child.data(), parent.data());
      for (std::size_t k = 0; k < child.size(); ++k) {
        expected += child[k] * polynomial(in_parent(octant, node_at(grid, k)));
      }
    }
    double found = 0.0;
    for (std::size_t k = 0; k < parent.size(); ++k) found += parent[k] * polynomial(node_at(grid, k));
    // Thousands of nodes now.
    EXPECT_NEAR(found, expected, 10.0 * kRounding) << "order " << order;
  }
}

TEST(LagrangeGrid, GivesAChildItsParentsPolynomial) {
  SCOPED_TRACE(::testing::Message() << "seed " << kLagrangeSeed);
  for (int order = 3; order <= kMaxOrder; ++order) {
    const LagrangeGrid grid(order);
    const Polynomial polynomial(order);
    std::vector<double> parent;
    for (std::size_t k = 0; k < grid.node_count(); ++k) parent.push_back(polynomial(node_at(grid, k)));
    for (int octant = 0; octant < 8; ++octant) {
      std::vector<double> child(grid.node_count(), 3.0);  // to be added to
      grid.parent_to_child(octant, parent.data(), child.data());
      for (std::size_t k = 0; k < child.size(); ++k) {
        ASSERT_NEAR(child[k], 3.0 + polynomial(in_parent(octant, node_at(grid, k))), kRounding) << "order " << order;
      }
    }
  }
}

}  // namespace
}  // namespace spinaltap::detail
