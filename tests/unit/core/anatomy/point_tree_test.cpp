#include "core/anatomy/point_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/base/random.h"
#include "core/grading/detail/nearest_cells.h"

namespace spinaltap {
namespace {

Vec3 random_point(std::uint64_t seed, std::uint64_t n) {
  return {10.0 * random_uniform(seed, 3 * n), 10.0 * random_uniform(seed, 3 * n + 1),
          10.0 * random_uniform(seed, 3 * n + 2)};
}

std::vector<Vec3> random_points(std::size_t count) {
  std::vector<Vec3> points_mm;
  for (std::size_t n = 0; n < count; ++n) points_mm.push_back(random_point(1, n));
  return points_mm;
}

double brute_force_mm(const std::vector<Vec3>& points_mm, const Vec3& p_mm) {
  double min_mm = std::numeric_limits<double>::infinity();
  for (const Vec3& point_mm : points_mm) min_mm = std::min(min_mm, (point_mm - p_mm).norm());
  return min_mm;
}

TEST(PointTree, FindsTheNearestWithAnyGuess) {
  const PointTree tree(random_points(2000));
  for (std::uint64_t n = 0; n < 200; ++n) {
    const Vec3 p_mm = 1.4 * random_point(2, n) - Vec3::Constant(2.0);
    const double ground_truth_mm = brute_force_mm(tree.points_mm(), p_mm);
    EXPECT_NEAR(tree.nearest(p_mm).distance_mm, ground_truth_mm, 1e-12);
    for (const std::size_t guess : {std::size_t{0}, tree.nearest(p_mm).index, std::size_t{1999}}) {
      EXPECT_NEAR(tree.nearest(p_mm, guess).distance_mm, ground_truth_mm, 1e-12);
    }
  }
}

TEST(NearestCells, FindWhatTheTreeFinds) {
  // Points at random, close together, and in a lattice whose neighbours are as near as each other from many places.
  std::vector<Vec3> lattice_mm;
  for (int n = 0; n < 1000; ++n) lattice_mm.emplace_back(n % 10, n / 10 % 10, n / 100);
  for (const std::vector<Vec3>& points_mm : {random_points(20'000), random_points(3), lattice_mm}) {
    const PointTree tree(points_mm);
    const NearestCells cells(tree);
    for (std::uint64_t n = 0; n < 3000; ++n) {
      // Into and around the points, and so far off that there is no cell; half of them between a lattice's points.
      const Vec3 at_mm = 4.0 * random_point(7, n) - Vec3::Constant(15.0);
      const Vec3 p_mm = n % 2 == 0 ? at_mm : Vec3(0.5 * (2.0 * at_mm).array().round());
      if (n % 5 == 0) cells.expect(std::vector<Vec3>{p_mm, at_mm, Vec3::Constant(1e6)});  // changes nothing
      ASSERT_EQ(cells.nearest(p_mm), tree.nearest(p_mm).index) << n << ": " << p_mm.transpose();
    }
    EXPECT_EQ(cells.nearest(Vec3::Constant(1e6)), tree.nearest(Vec3::Constant(1e6)).index);
    EXPECT_EQ(cells.nearest(Vec3::Constant(std::numeric_limits<double>::quiet_NaN())), PointTree::Nearest{}.index);
  }
  const PointTree none({});
  EXPECT_EQ(NearestCells(none).nearest(Vec3::Zero()), PointTree::Nearest{}.index);
}

TEST(PointTree, HoldsAllPointsAlongALine) {
  const PointTree tree(random_points(5000));
  std::size_t looked_at = 0;
  for (std::uint64_t n = 0; n < 50; ++n) {
    const Vec3 origin_mm = 1.4 * random_point(3, n) - Vec3::Constant(2.0);
    const Vec3 direction = (random_point(4, n) - Vec3::Constant(5.0)).normalized();
    const PointTree::Stretch stretch{origin_mm, direction, -1.0, 6.0 * random_uniform(5, n), random_uniform(6, n)};
    std::vector<std::size_t> near = tree.along(stretch);
    std::sort(near.begin(), near.end());
    EXPECT_EQ(std::adjacent_find(near.begin(), near.end()), near.end());  // none twice
    looked_at += near.size();
    for (std::size_t place = 0; place < tree.points_mm().size(); ++place) {
      const Vec3 way_mm = tree.points_mm()[place] - origin_mm;
      const double along_mm = way_mm.dot(direction);
      const bool is_in = along_mm >= stretch.from_mm && along_mm <= stretch.to_mm &&
                         (way_mm - along_mm * direction).norm() <= stretch.reach_mm;
      EXPECT_TRUE(!is_in || std::binary_search(near.begin(), near.end(), place)) << "line " << n << ", point " << place;
    }
  }
  EXPECT_LT(looked_at, 50 * tree.points_mm().size() / 2);  // most are passed over
}

TEST(PointTree, HasEachPointInOneGroupWhoseBallHoldsIt) {
  const PointTree tree(random_points(1000));
  double radii_mm = 0.0;
  std::vector<int> times(tree.points_mm().size(), 0);
  for (const PointTree::Group& group : tree.groups()) {
    radii_mm += group.radius_mm;
    for (const std::uint32_t place : group.points) {
      ++times[place];
      EXPECT_LE((tree.points_mm()[place] - group.middle_mm).norm(), group.radius_mm + 1e-12);
    }
  }
  EXPECT_EQ(std::count(times.begin(), times.end(), 1), 1000);
  // Neighbours: the ball around the whole cube has 8.7 mm, one around a sixteenth of it 3.4 mm or a little more.
  EXPECT_LT(radii_mm / static_cast<double>(tree.groups().size()), 6.0);
  EXPECT_TRUE(PointTree(std::vector<Vec3>{}).groups().empty());
}

}  // namespace
}  // namespace spinaltap
