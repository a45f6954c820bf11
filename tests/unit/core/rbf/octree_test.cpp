#include "core/rbf/detail/octree.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap::detail {
namespace {

constexpr std::uint64_t kOctreeSeed = 17;

std::vector<std::vector<Vec3>> sets_to_sort() {
  return {test::random_points(3000, kOctreeSeed), test::ball_points(3000), test::clustered_points(3000, kOctreeSeed)};
}

TEST(Octree, HoldsEveryPointInExactlyOneLeaf) {
  SCOPED_TRACE(::testing::Message() << "seed " << kOctreeSeed);
  for (const std::vector<Vec3>& points_mm : sets_to_sort()) {
    for (const std::size_t leaf_size : {1U, 10U, 200U}) {
      const Octree tree(points_mm, leaf_size);
      std::vector<int> met(points_mm.size(), 0);
      for (std::uint32_t b = 0; b < tree.boxes().size(); ++b) {
        const Octree::Box& box = tree.boxes()[b];
        if (!box.is_leaf()) continue;
        for (std::uint32_t i = box.begin; i < box.end; ++i) {
          const std::uint32_t point = tree.sorted()[i];
          ++met[point];
          const Vec3 off = points_mm[point] - tree.centre_mm(box);
          // Centres round to 1e-15 of the cube of 20 mm.
          ASSERT_LE(off.cwiseAbs().maxCoeff(), tree.half_width_mm(box) + 1e-13);
          ASSERT_EQ(tree.leaf_at(points_mm[point]), b);
        }
      }
      EXPECT_EQ(std::count(met.begin(), met.end(), 1), static_cast<std::ptrdiff_t>(points_mm.size()));
    }
  }
}

TEST(Octree, DividesBoxesThatHoldTooManyAndNoOthers) {
  SCOPED_TRACE(::testing::Message() << "seed " << kOctreeSeed);
  for (const std::vector<Vec3>& points_mm : sets_to_sort()) {
    constexpr std::size_t kLeafSize = 30;
    const Octree tree(points_mm, kLeafSize);
    for (const Octree::Box& box : tree.boxes()) {
      EXPECT_EQ(box.is_leaf(), box.count() <= kLeafSize) << "level " << box.level;
    }
  }
}

TEST(Octree, DividesBoxesBesideCrowdsAsWell) {
  SCOPED_TRACE(::testing::Message() << "seed " << kOctreeSeed);
  constexpr std::size_t kLeafSize = 30;
  std::size_t for_others = 0;  // of evenly spread points all boxes are full themselves
  for (const std::vector<Vec3>& points_mm : sets_to_sort()) {
    for (const std::size_t beside_size : {kLeafSize, 3 * kLeafSize}) {
      const Octree tree(points_mm, kLeafSize, beside_size);
      for (std::uint32_t level = 0; level + 1 < tree.level_begin().size(); ++level) {
        for (std::uint32_t a = tree.level_begin()[level]; a < tree.level_begin()[level + 1]; ++a) {
          bool is_beside = false;
          for (std::uint32_t b = tree.level_begin()[level]; b < tree.level_begin()[level + 1]; ++b) {
            const Octree::Box& other = tree.boxes()[b];
            is_beside = is_beside || (other.count() > beside_size && are_adjacent(tree.boxes()[a], other));
          }
          const bool is_full = tree.boxes()[a].count() > kLeafSize;
          ASSERT_EQ(tree.boxes()[a].is_leaf(), !is_full && !is_beside) << "level " << level;
          if (!is_full && is_beside) ++for_others;
        }
      }
      std::size_t points = 0;
      for (const Octree::Box& box : tree.boxes()) points += box.is_leaf() ? box.count() : 0;
      EXPECT_EQ(points, points_mm.size());
    }
  }
  EXPECT_GT(for_others, 100U);
}

TEST(Octree, NumbersBoxesLevelByLevelAndChildrenByOctant) {
  const Octree tree(test::clustered_points(3000, kOctreeSeed), 20);
  const auto& boxes = tree.boxes();
  const auto& level_begin = tree.level_begin();
  ASSERT_EQ(level_begin.front(), 0U);
  ASSERT_EQ(level_begin.back(), boxes.size());
  for (std::size_t level = 0; level + 1 < level_begin.size(); ++level) {
    for (std::uint32_t b = level_begin[level]; b < level_begin[level + 1]; ++b) {
      EXPECT_EQ(boxes[b].level, static_cast<int>(level));
      if (boxes[b].is_leaf()) continue;
      std::uint32_t next = boxes[b].begin;
      for (std::uint32_t octant = 0; octant < 8; ++octant) {
        const Octree::Box& child = boxes[boxes[b].first_child + octant];
        EXPECT_EQ(child.parent, b);
        EXPECT_EQ(child.begin, next);
        next = child.end;
        const Vec3 side(octant & 1U ? 0.5 : -0.5, octant & 2U ? 0.5 : -0.5, octant & 4U ? 0.5 : -0.5);
        const Vec3 expected = tree.centre_mm(boxes[b]) + tree.half_width_mm(boxes[b]) * side;
        EXPECT_LT((tree.centre_mm(child) - expected).norm(), 1e-13);  // see above
      }
      EXPECT_EQ(next, boxes[b].end);
    }
  }
}

TEST(Octree, FindsTheLeafOfPlacesWithoutPointsToo) {
  SCOPED_TRACE(::testing::Message() << "seed " << kOctreeSeed);
  const Octree tree(test::clustered_points(2000, kOctreeSeed), 20);
  for (std::uint64_t n = 0; n < 500; ++n) {
    const Octree::Box& root = tree.boxes().front();
    const Vec3 p = tree.centre_mm(root) + test::random_place(kOctreeSeed + 9, n, tree.half_width_mm(root));
    ASSERT_TRUE(tree.contains(p));
    const Octree::Box& leaf = tree.boxes()[tree.leaf_at(p)];
    EXPECT_TRUE(leaf.is_leaf());
    EXPECT_LE((p - tree.centre_mm(leaf)).cwiseAbs().maxCoeff(), tree.half_width_mm(leaf) + 1e-13);
  }
}

TEST(Octree, ContainsACubeALittleLargerThanItsPoints) {
  const Octree tree(std::vector<Vec3>{Vec3(0, 0, 0), Vec3(10, 4, 2)}, 1);
  // 10 mm and a tenth more, around the middle.
  EXPECT_TRUE(tree.contains(Vec3(-0.49, 2, 1)));
  EXPECT_FALSE(tree.contains(Vec3(-0.51, 2, 1)));
  EXPECT_TRUE(tree.contains(Vec3(5, 7.49, -4.49)));
  EXPECT_FALSE(tree.contains(Vec3(5, 7.51, 1)));
  EXPECT_FALSE(tree.contains(Vec3(5, 2, std::nan(""))));
}

TEST(Octree, EndsAtABoundedDepthWhenPointsAreTheSame) {
  std::vector<Vec3> points_mm(100, Vec3(1, 2, 3));
  for (const bool other : {false, true}) {
    if (other) points_mm.emplace_back(7, 7, 7);
    const Octree tree(points_mm, 10);
    int deepest = 0;
    for (const Octree::Box& box : tree.boxes()) deepest = std::max(deepest, box.level);
    EXPECT_EQ(deepest, Octree::kDeepest);
    EXPECT_EQ(tree.boxes().size(), 1U + 8U * Octree::kDeepest);
    EXPECT_EQ(tree.boxes()[tree.leaf_at(points_mm[0])].count(), 100U);
  }
}

TEST(Octree, TakesASinglePoint) {
  const Octree tree(std::vector<Vec3>{Vec3(1, 2, 3)}, 1);
  ASSERT_EQ(tree.boxes().size(), 1U);
  EXPECT_TRUE(tree.contains(Vec3(1, 2, 3)));
  EXPECT_EQ(tree.leaf_at(Vec3(1, 2, 3)), 0U);
}

TEST(Octree, TellsBoxesThatTouch) {
  SCOPED_TRACE(::testing::Message() << "seed " << kOctreeSeed);
  const Octree tree(test::clustered_points(500, kOctreeSeed), 20);
  for (const Octree::Box& a : tree.boxes()) {
    for (const Octree::Box& b : tree.boxes()) {
      const double gap_mm =
          (tree.centre_mm(a) - tree.centre_mm(b)).cwiseAbs().maxCoeff() - tree.half_width_mm(a) - tree.half_width_mm(b);
      // Rounding is 1e-14 mm, the smallest gap a deepest box's width: more than 1e-5 mm.
      ASSERT_EQ(are_adjacent(a, b), gap_mm < 1e-9);
    }
  }
}

}  // namespace
}  // namespace spinaltap::detail
