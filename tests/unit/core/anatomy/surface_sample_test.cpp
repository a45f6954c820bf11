#include "core/anatomy/surface_sample.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/error.h"

namespace spinaltap {
namespace {

TEST(FirstOfEachCell, KeepsTheFirstPointOfACell) {
  const std::vector<Vec3> points_mm{
      {0.1, 0.1, 0.1}, {0.9, 0.9, 0.9}, {1.1, 0.1, 0.1}, {-0.1, 0.0, 0.0}, {1.9, 0.5, 0.2}};
  EXPECT_EQ(first_of_each_cell(points_mm, Vec3::Zero(), 1.0), (std::vector<std::size_t>{0, 2, 3}));
}

TEST(FirstOfEachCell, CountsCellsFromTheirOrigin) {
  const std::vector<Vec3> points_mm{{0.4, 0.0, 0.0}, {0.6, 0.0, 0.0}};
  EXPECT_EQ(first_of_each_cell(points_mm, Vec3::Zero(), 1.0).size(), 1U);
  EXPECT_EQ(first_of_each_cell(points_mm, Vec3(0.5, 0.0, 0.0), 1.0).size(), 2U);
}

TEST(FirstOfEachCell, TakesNoPoints) { EXPECT_TRUE(first_of_each_cell({}, Vec3::Zero(), 1.0).empty()); }

TEST(FirstOfEachCell, RejectsPointsFarApartAndThoseThatAreNone) {
  const std::vector<Vec3> far_mm{Vec3::Zero(), Vec3::Constant(1e4)};
  EXPECT_THROW(first_of_each_cell(far_mm, Vec3::Zero(), 0.1), Error);
  const std::vector<Vec3> none_mm{Vec3::Zero(), Vec3::Constant(std::numeric_limits<double>::quiet_NaN())};
  EXPECT_THROW(first_of_each_cell(none_mm, Vec3::Zero(), 0.1), Error);
}

}  // namespace
}  // namespace spinaltap
