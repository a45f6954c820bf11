// Compiled with optimisation: long loops of its own.

#include "core/rbf/detail/interaction_lists.h"

#include <gtest/gtest.h>

#include "tests/support/test_kind.h"
#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap::detail {
namespace {

constexpr std::uint64_t kListSeed = 29;

struct PointSet {
  const char* name;
  std::vector<Vec3> points_mm;
};

std::vector<PointSet> listed_sets() {
  std::vector<Vec3> mixed = test::random_points(300, kListSeed);
  for (const Vec3& p : test::clustered_points(1200, kListSeed)) mixed.push_back(p);
  for (int i = 0; i < 100; ++i) mixed.emplace_back(1.0, 2.0, 3.0);  // a leaf at the deepest level
  return {{"even", test::random_points(2500, kListSeed)},
          {"a surface", test::ball_points(2500)},
          {"clusters", test::clustered_points(2500, kListSeed)},
          {"clusters in an even set, and one point many times", mixed},
          {"few", test::random_points(5, kListSeed)}};
}

template <class Check>
void for_each_case(const Check& check) {
  SCOPED_TRACE(::testing::Message() << "seed " << kListSeed);
  for (const PointSet& one : listed_sets()) {
    for (const std::uint32_t beside : {15U, 40U, Octree::kNone}) {
      const Octree tree(one.points_mm, 15, beside);
      for (const bool anywhere : {false, true}) {
        for (const std::size_t few : {1U, 8U, 200U}) {
          SCOPED_TRACE(::testing::Message()
                       << one.name << ", beside " << beside << ", anywhere " << anywhere << ", few " << few);
          std::vector<bool> is_target;
          for (const Octree::Box& box : tree.boxes()) is_target.push_back(anywhere || box.count() > 0);
          check(tree, is_target, few, make_lists(tree, is_target, few));
        }
      }
    }
  }
}

SLOW_TESTS("InteractionLists.CoverEverySourceOnceForEveryLeaf");

TEST(InteractionLists, CoverEverySourceOnceForEveryLeaf) {
  for_each_case([](const Octree& tree, const std::vector<bool>& is_target, std::size_t, const InteractionLists& lists) {
    const auto& boxes = tree.boxes();
    for (std::uint32_t leaf = 0; leaf < boxes.size(); ++leaf) {
      if (!boxes[leaf].is_leaf() || !is_target[leaf]) continue;
      std::vector<int> covered(tree.sorted().size(), 0);
      const auto cover = [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) ++covered[i];
      };
      for (const SourceRange* r = lists.near.begin(leaf); r != lists.near.end(leaf); ++r) cover(r->begin, r->end);
      for (const std::uint32_t* f = lists.finer.begin(leaf); f != lists.finer.end(leaf); ++f) {
        cover(boxes[*f].begin, boxes[*f].end);
      }
      for (std::uint32_t b = leaf; b != Octree::kNone; b = boxes[b].parent) {
        for (const FarBox* f = lists.far.begin(b); f != lists.far.end(b); ++f) {
          cover(boxes[f->box].begin, boxes[f->box].end);
        }
        for (const std::uint32_t* c = lists.coarser.begin(b); c != lists.coarser.end(b); ++c) {
          cover(boxes[*c].begin, boxes[*c].end);
        }
      }
      for (const int times : covered) ASSERT_EQ(times, 1) << "leaf " << leaf;
    }
  });
}

TEST(InteractionLists, UseExpansionsOnlyWhereBoxesAreApart) {
  for_each_case(
      [](const Octree& tree, const std::vector<bool>& is_target, std::size_t few, const InteractionLists& lists) {
        const auto& boxes = tree.boxes();
        for (std::uint32_t b = 0; b < boxes.size(); ++b) {
          if (!is_target[b]) {
            EXPECT_EQ(lists.far.count(b) + lists.near.count(b) + lists.finer.count(b) + lists.coarser.count(b), 0U);
            continue;
          }
          for (const FarBox* f = lists.far.begin(b); f != lists.far.end(b); ++f) {
            const Octree::Box& source = boxes[f->box];
            ASSERT_EQ(source.level, boxes[b].level);
            ASSERT_FALSE(are_adjacent(source, boxes[b]));
            ASSERT_TRUE(are_adjacent(boxes[source.parent], boxes[boxes[b].parent]));
            const int offset[3] = {static_cast<int>(f->offset % 7) - 3, static_cast<int>(f->offset / 7 % 7) - 3,
                                   static_cast<int>(f->offset / 49) - 3};
            for (std::size_t axis = 0; axis < 3; ++axis) {
              ASSERT_EQ(offset[axis], boxes[b].at[axis] - source.at[axis]);
            }
          }
          for (const std::uint32_t* f = lists.finer.begin(b); f != lists.finer.end(b); ++f) {
            ASSERT_TRUE(boxes[b].is_leaf());
            ASSERT_GT(boxes[*f].level, boxes[b].level);
            ASSERT_FALSE(are_adjacent(boxes[*f], boxes[b]));
            ASSERT_GE(boxes[*f].count(), few);
          }
          for (const std::uint32_t* c = lists.coarser.begin(b); c != lists.coarser.end(b); ++c) {
            ASSERT_TRUE(boxes[*c].is_leaf());
            ASSERT_LT(boxes[*c].level, boxes[b].level);
            ASSERT_FALSE(are_adjacent(boxes[*c], boxes[b]));
            ASSERT_GE(boxes[b].count(), few);
          }
        }
      });
}

TEST(InteractionLists, KeepSourcesFewWhereBoxesBesideCrowdsAreDivided) {
  SCOPED_TRACE(::testing::Message() << "seed " << kListSeed);
  constexpr std::size_t kLeafSize = 15;
  for (const std::vector<Vec3>& points_mm :
       {test::random_points(2500, kListSeed), test::ball_points(2500), test::clustered_points(2500, kListSeed)}) {
    const Octree tree(points_mm, kLeafSize, kLeafSize);
    const InteractionLists lists = make_lists(tree, std::vector<bool>(tree.boxes().size(), true), 8);
    for (std::uint32_t b = 0; b < tree.boxes().size(); ++b) {
      if (!tree.boxes()[b].is_leaf()) continue;
      ASSERT_LT(tree.boxes()[b].level, Octree::kDeepest);
      // No box beside it is crowded: none is divided further for its own points' sake.
      for (const std::uint32_t* f = lists.finer.begin(b); f != lists.finer.end(b); ++f) {
        ASSERT_LE(tree.boxes()[*f].count(), kLeafSize);
      }
    }
  }
}

TEST(InteractionLists, UseEveryKindWhereDensitiesDiffer) {
  const Octree tree(test::clustered_points(4000, kListSeed), 15);
  const InteractionLists lists = make_lists(tree, std::vector<bool>(tree.boxes().size(), true), 8);
  std::size_t far = 0;
  std::size_t near = 0;
  std::size_t finer = 0;
  std::size_t coarser = 0;
  for (std::uint32_t b = 0; b < tree.boxes().size(); ++b) {
    far += lists.far.count(b);
    near += lists.near.count(b);
    finer += lists.finer.count(b);
    coarser += lists.coarser.count(b);
  }
  EXPECT_GT(far, 0U);
  EXPECT_GT(near, 0U);
  EXPECT_GT(finer, 0U);
  EXPECT_GT(coarser, 0U);
}

}  // namespace
}  // namespace spinaltap::detail
