#include "core/rbf/detail/coarse_to_fine.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>

#include "core/rbf/detail/polynomial.h"
#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap::detail {
namespace {

constexpr std::uint64_t kOrderSeed = 97;
constexpr std::size_t kOrdered = 1200;

std::vector<std::vector<Vec3>> sets_to_order() {
  return {test::random_points(kOrdered, kOrderSeed), test::ball_points(kOrdered),
          test::clustered_points(kOrdered, kOrderSeed)};
}

std::vector<std::uint32_t> first_of(const std::vector<Vec3>& points_mm) {
  return determining_points(RadialKernel::biharmonic, points_mm);
}

TEST(CoarseToFine, IsAPermutationThatBeginsAsAsked) {
  SCOPED_TRACE(::testing::Message() << "seed " << kOrderSeed);
  for (const std::vector<Vec3>& points_mm : sets_to_order()) {
    const std::vector<std::uint32_t> first = first_of(points_mm);
    const CoarseToFine found = coarse_to_fine(points_mm, first, 10);
    ASSERT_EQ(found.order.size(), kOrdered);
    EXPECT_TRUE(std::equal(first.begin(), first.end(), found.order.begin()));
    std::vector<std::uint32_t> sorted = found.order;
    std::sort(sorted.begin(), sorted.end());
    for (std::uint32_t i = 0; i < kOrdered; ++i) ASSERT_EQ(sorted[i], i);
  }
}

TEST(CoarseToFine, SpreadsEveryBeginningOfTheOrder) {
  SCOPED_TRACE(::testing::Message() << "seed " << kOrderSeed);
  for (const std::vector<Vec3>& points_mm : sets_to_order()) {
    const std::vector<std::uint32_t> first = first_of(points_mm);
    const std::vector<std::uint32_t> order = coarse_to_fine(points_mm, first, 1).order;
    // Added one by one: how far each is from those before it, and how far all are from those taken.
    std::vector<double> to_taken_mm(kOrdered, std::numeric_limits<double>::infinity());
    double separation_mm = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < kOrdered; ++k) {
      // The last fiftieth, points that are near to others, comes as it stands.
      if (k >= first.size() && 50 * k < 49 * kOrdered) {
        separation_mm = std::min(separation_mm, to_taken_mm[order[k]]);
        const double covering_mm = *std::max_element(to_taken_mm.begin(), to_taken_mm.end());
        // The greatest distance left is at most one step of 15 % above what points keep from each other.
        ASSERT_LE(covering_mm, separation_mm / 0.85 * (1.0 + 1e-12)) << "place " << k;
      }
      for (std::size_t i = 0; i < kOrdered; ++i) {
        to_taken_mm[i] = std::min(to_taken_mm[i], (points_mm[i] - points_mm[order[k]]).norm());
      }
    }
  }
}

/// Compares the neighbours with those that looking at all points gives.
void expect_nearest(const std::vector<Vec3>& points_mm, const CoarseToFine& found) {
  for (std::size_t k = 0; k < points_mm.size(); ++k) {
    std::vector<std::pair<double, std::uint32_t>> before;
    for (std::uint32_t j = 0; j < k; ++j) {
      before.emplace_back((points_mm[found.order[k]] - points_mm[found.order[j]]).squaredNorm(), j);
    }
    ASSERT_EQ(found.count(k), std::min(k, found.neighbours));
    std::partial_sort(before.begin(), before.begin() + static_cast<std::ptrdiff_t>(found.count(k)), before.end());
    std::vector<std::uint32_t> expected;
    for (std::size_t i = 0; i < found.count(k); ++i) expected.push_back(before[i].second);
    const auto begin = found.near.begin() + static_cast<std::ptrdiff_t>(k * found.neighbours);
    std::vector<std::uint32_t> near(begin, begin + static_cast<std::ptrdiff_t>(found.count(k)));
    if (k <= found.neighbours) std::sort(expected.begin(), expected.end());  // all of them, in their order
    ASSERT_EQ(near, expected) << "place " << k;
  }
}

TEST(CoarseToFine, FindsTheNearestOfThoseBefore) {
  SCOPED_TRACE(::testing::Message() << "seed " << kOrderSeed);
  for (const std::vector<Vec3>& points_mm : sets_to_order()) {
    for (const std::size_t neighbours : {1U, 12U, 40U}) {
      expect_nearest(points_mm, coarse_to_fine(points_mm, first_of(points_mm), neighbours));
    }
  }
}

TEST(CoarseToFine, TakesAClusterThatIsFarDenserThanTheRest) {
  SCOPED_TRACE(::testing::Message() << "seed " << kOrderSeed);
  // The neighbours of the cluster's points lie 1e7 of its spacings away.
  std::vector<Vec3> points_mm = test::random_points(60, kOrderSeed);
  for (const Vec3& p : test::random_points(38, kOrderSeed + 1, 1e-6)) points_mm.push_back(Vec3(1, 2, 3) + p);
  expect_nearest(points_mm, coarse_to_fine(points_mm, first_of(points_mm), 40));
}

TEST(CoarseToFine, TakesAsFewPointsAsThePolynomialHasTerms) {
  const std::vector<Vec3> points_mm{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  const CoarseToFine found = coarse_to_fine(points_mm, first_of(points_mm), 3);
  EXPECT_EQ(found.order, first_of(points_mm));
}

TEST(CoarseToFine, IsTheSameAtAnyNumberOfThreads) {
  SCOPED_TRACE(::testing::Message() << "seed " << kOrderSeed);
  for (const std::vector<Vec3>& points_mm : sets_to_order()) {
    const auto order = [&](std::size_t threads) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      return coarse_to_fine(points_mm, first_of(points_mm), 20);
    };
    const CoarseToFine one = order(1);
    const CoarseToFine two = order(2);
    EXPECT_EQ(one.order, two.order);
    EXPECT_EQ(one.near, two.near);
  }
}

}  // namespace
}  // namespace spinaltap::detail
