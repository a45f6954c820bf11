// Compiled with optimisation: long loops of its own.

#include "core/rbf/detail/far_field.h"

#include <gtest/gtest.h>

#include "core/rbf/detail/lagrange_grid.h"
#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap::detail {
namespace {

constexpr std::uint64_t kFarFieldSeed = 61;

/// The tree, its lists, and a number for each box that has a place among the nodes.
struct Scene {
  explicit Scene(const std::vector<Vec3>& points_mm) : tree(points_mm, 8) {
    std::uint32_t boxes = 0;
    for (const Octree::Box& box : tree.boxes()) {
      is_target.push_back(box.count() > 0);
      slot.push_back(is_target.back() ? boxes++ : Octree::kNone);
    }
    box_count = boxes;
    lists = make_lists(tree, is_target, 1);
  }
  Octree tree;
  std::vector<bool> is_target;
  std::vector<std::uint32_t> slot;
  std::size_t box_count = 0;
  InteractionLists lists;
};

std::vector<Vec3> nodes_of(const Octree& tree, const Octree::Box& box, int order) {
  const LagrangeGrid grid(order);
  std::vector<Vec3> nodes_mm;
  for (int z = 0; z < order; ++z) {
    for (int y = 0; y < order; ++y) {
      for (int x = 0; x < order; ++x) {
        nodes_mm.emplace_back(tree.centre_mm(box) +
                              tree.half_width_mm(box) * Vec3(grid.node(x), grid.node(y), grid.node(z)));
      }
    }
  }
  return nodes_mm;
}

TEST(FarField, IsTheSumOverAllPairsOfNodes) {
  SCOPED_TRACE(::testing::Message() << "seed " << kFarFieldSeed);
  const Scene scene(test::random_points(3000, kFarFieldSeed));
  ASSERT_GT(scene.tree.level_begin().size(), 4U);  // levels 0 to 3 at least
  for (const auto kernel : {RadialKernel::biharmonic, RadialKernel::triharmonic}) {
    for (const double c2 : {0.0, 0.6}) {
      for (const int order : {3, 4, 7}) {
        SCOPED_TRACE(::testing::Message() << "power " << (kernel == RadialKernel::biharmonic ? 1 : 3) << ", c2 " << c2
                                          << ", order " << order);
        const std::size_t nodes = LagrangeGrid(order).node_count();
        const std::vector<double> multipole = test::random_weights(scene.box_count * nodes, kFarFieldSeed + 1);
        std::vector<double> local(multipole.size(), 5.0);  // to be added to
        FarField far_field(kernel, c2, order, best_simd_kernels());
        // Level 2 again at the end: the table of one level must not serve another.
        for (const std::size_t level : {2U, 3U, 2U}) {
          far_field.translate(scene.tree, scene.lists, scene.tree.level_begin()[level],
                              scene.tree.level_begin()[level + 1], scene.slot, multipole, scene.slot, local);
        }
        for (const std::size_t level : {2U, 3U}) {
          const double times = level == 2 ? 2.0 : 1.0;
          const std::uint32_t begin = scene.tree.level_begin()[level];
          const std::uint32_t end = scene.tree.level_begin()[level + 1];
          for (std::uint32_t b = begin; b < end; b += 61) {
            if (!scene.is_target[b]) continue;
            const std::vector<Vec3> targets_mm = nodes_of(scene.tree, scene.tree.boxes()[b], order);
            std::vector<std::vector<Vec3>> sources_mm;
            for (const FarBox* f = scene.lists.far.begin(b); f != scene.lists.far.end(b); ++f) {
              sources_mm.push_back(nodes_of(scene.tree, scene.tree.boxes()[f->box], order));
            }
            for (std::size_t t = 0; t < nodes; t += 7) {
              double sum = 0.0;
              double size = 0.0;
              for (std::size_t k = 0; k < sources_mm.size(); ++k) {
                const std::uint32_t box = scene.lists.far.begin(b)[k].box;
                for (std::size_t s = 0; s < nodes; ++s) {
                  const double term = multipole[scene.slot[box] * nodes + s] *
                                      phi(kernel, (targets_mm[t] - sources_mm[k][s]).squaredNorm(), c2);
                  sum += term;
                  size += std::abs(term);
                }
              }
              // Transforms mix all numbers: rounding is that of the sum of magnitudes.
              ASSERT_NEAR(local[scene.slot[b] * nodes + t], 5.0 + times * sum, 1e-14 * size + 1e-13)
                  << "level " << level;
            }
          }
        }
      }
    }
  }
}

TEST(FarField, LeavesBoxesWithoutFarOnesAlone) {
  const Scene scene(test::random_points(100, kFarFieldSeed));
  std::vector<double> local(scene.box_count * 27, 5.0);
  const std::vector<double> multipole(scene.box_count * 27, 1.0);
  FarField far_field(RadialKernel::biharmonic, 0.0, 3, best_simd_kernels());
  far_field.translate(scene.tree, scene.lists, 1, 9, scene.slot, multipole, scene.slot, local);  // all are adjacent
  EXPECT_EQ(local, std::vector<double>(scene.box_count * 27, 5.0));
}

}  // namespace
}  // namespace spinaltap::detail
