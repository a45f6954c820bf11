#include "core/engine/detail/empty_circles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/base/geometry.h"
#include "tests/unit/core/engine/askew_block.h"

namespace spinaltap {
namespace {

TEST(EmptyCircles, NeverPromiseMoreRoomThanThereIsWhileTheHoleGrows) {
  test::Draw draw(161);
  // A hole of 2 mm, of which bone is taken as places come.
  std::vector<Eigen::Vector2d> occupied;
  for (int n = 0; n < 20'000; ++n) occupied.emplace_back(draw(-4.0, 4.0), draw(-4.0, 4.0));
  const auto min_distance_mm = [&](double x_mm, double y_mm) {
    double least_mm = 1e15;
    for (const Eigen::Vector2d& p : occupied) least_mm = std::min(least_mm, (p - Eigen::Vector2d(x_mm, y_mm)).norm());
    return least_mm;
  };
  EmptyCircles circles(3);
  std::size_t useful = 0;
  constexpr int kPlaces = 300;
  for (int n = 0; n < kPlaces; ++n) {
    const Eigen::Vector2d place(draw(0.3, 0.5), draw(-0.7, -0.5));
    const double clear_mm = circles.clear_mm(1, place.x(), place.y());
    ASSERT_LE(clear_mm, min_distance_mm(place.x(), place.y()) + 1e-12);
    useful += clear_mm > 1.5;
    std::erase_if(occupied, [&](const Eigen::Vector2d& p) { return (p - place).norm() < 2.0; });
    circles.renew(1, place.x(), place.y(), min_distance_mm);
  }
  EXPECT_GT(useful, kPlaces * 9 / 10);
  // Of discs that nobody looked at nothing is known.
  EXPECT_LT(circles.clear_mm(0, 0.0, 0.0), 0.0);
  EXPECT_LT(circles.clear_mm(2, 1e6, 0.0), 0.0);
}

}  // namespace
}  // namespace spinaltap
