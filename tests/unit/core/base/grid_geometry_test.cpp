#include "core/ct/grid_geometry.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/error.h"

namespace spinaltap {
namespace {

GridGeometry askew() {
  GridGeometry geometry;
  geometry.size = {7, 6, 5};
  geometry.origin_mm = Vec3(1000.0, -200.0, 30.0);
  geometry.spacing_mm = Vec3(0.5, 0.7, 1.25);
  geometry.directions = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  return geometry;
}

TEST(GridGeometry, CountsColumnsFastest) {
  const GridGeometry geometry = askew();
  EXPECT_EQ(geometry.voxel_count(), 210U);
  std::size_t next = 0;
  for (int k = 0; k < 5; ++k) {
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 7; ++i) EXPECT_EQ(geometry.offset(i, j, k), next++);
    }
  }
  EXPECT_TRUE(geometry.contains(6, 5, 4));
  EXPECT_FALSE(geometry.contains(7, 0, 0));
  EXPECT_FALSE(geometry.contains(0, -1, 0));
}

TEST(GridGeometry, FindsItsWayToThePatientAndBack) {
  const GridGeometry geometry = askew();
  EXPECT_EQ(geometry.to_patient(Vec3::Zero()), geometry.origin_mm);
  const Vec3 p_index(1.25, -3.5, 4.0);
  // A double holds 1,000 mm to 1e-13 mm.
  EXPECT_LT((geometry.to_index(geometry.to_patient(p_index)) - p_index).norm(), 1e-11);
  const Vec3 step_mm = geometry.to_patient(Vec3(1, 0, 0)) - geometry.origin_mm;
  EXPECT_LT((step_mm - 0.5 * geometry.directions.col(0)).norm(), 1e-12);
  EXPECT_LT((geometry.index_to_patient_matrix() * p_index + geometry.origin_mm - geometry.to_patient(p_index)).norm(),
            1e-12);
  EXPECT_EQ(geometry.smallest_spacing_mm(), 0.5);
}

TEST(GridGeometry, IsRejectedWithoutSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto rejected = [](const auto& change) {
    GridGeometry geometry = askew();
    change(geometry);
    EXPECT_THROW(check_geometry(geometry, "test"), Error);
  };
  EXPECT_NO_THROW(check_geometry(askew(), "test"));
  rejected([](GridGeometry& g) { g.size[1] = 0; });
  rejected([](GridGeometry& g) { g.size[2] = -5; });
  rejected([](GridGeometry& g) { g.size = {2'000'000'000, 2'000'000'000, 2'000'000'000}; });  // would overflow
  rejected([&](GridGeometry& g) { g.origin_mm.y() = nan; });
  rejected([](GridGeometry& g) { g.spacing_mm.z() = 0.0; });
  rejected([&](GridGeometry& g) { g.spacing_mm.x() = nan; });
  rejected([](GridGeometry& g) { g.spacing_mm.x() = std::numeric_limits<double>::infinity(); });
  rejected([](GridGeometry& g) { g.directions.col(0) *= 1.01; });
  rejected([](GridGeometry& g) { g.directions.col(0) = g.directions.col(1); });
  EXPECT_THROW(check_geometry(askew(), "test", 209), Error);
  EXPECT_NO_THROW(check_geometry(askew(), "test", 210));
}

TEST(GridGeometry, IsRejectedWithAxesThatAreNotNumbers) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      GridGeometry geometry = askew();
      geometry.directions(row, column) = std::numeric_limits<double>::quiet_NaN();
      EXPECT_THROW(check_geometry(geometry, "test"), Error) << row << " " << column;
    }
  }
}

}  // namespace
}  // namespace spinaltap
