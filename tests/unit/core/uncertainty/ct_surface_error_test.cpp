#include "core/uncertainty/ct_surface_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {
namespace {

const std::vector<double> kSlopes{300.0, 400.0, 500.0};
const std::vector<Vec3> kAllSides{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};

CtSurfaceError error_of_slices(double step_mm, double thickness_mm = 0.0) {
  return ct_surface_error(12.0, {Vec3(0.7, 0.7, step_mm), thickness_mm}, kSlopes, kAllSides);
}

TEST(CtSurfaceError, GrowsWithTheSlicesAndMostWhereWallsFaceAlongThem) {
  // Of the noise alone 12 / 400 mm; of a straight edge across voxels of 0.7 mm 0.0624 of them.
  EXPECT_GT(error_of_slices(0.7).standard_error_mm(Vec3::UnitX()), std::hypot(0.03, 0.0624 * 0.7));
  double before_mm = 0.0;
  for (const double step_mm : {0.5, 1.0, 2.0, 3.0, 4.0, 5.0}) {
    const CtSurfaceError error = error_of_slices(step_mm);
    EXPECT_GT(error.standard_error_mm(), before_mm);
    before_mm = error.standard_error_mm();
    if (step_mm < 1.0) continue;
    EXPECT_GT(error.standard_error_mm(Vec3::UnitZ()), error.standard_error_mm(Vec3::UnitX()));
    EXPECT_DOUBLE_EQ(error.standard_error_mm(Vec3::UnitZ()), error.standard_error_mm(-Vec3::UnitZ()));
  }
  // What slices of 5 mm show of a wall across them is not known to a quarter of a millimetre, nor of one along them.
  EXPECT_GT(error_of_slices(5.0).standard_error_mm(Vec3::UnitZ()), 1.0);
  EXPECT_GT(error_of_slices(5.0).standard_error_mm(Vec3::UnitX()), 0.4);
}

TEST(CtSurfaceError, TakesSlicesThatOverlapForAsThickAsTheyAre) {
  EXPECT_EQ(error_of_slices(1.0, 1.0).standard_error_mm(), error_of_slices(1.0).standard_error_mm());
  EXPECT_EQ(error_of_slices(1.0, 0.5).standard_error_mm(), error_of_slices(1.0).standard_error_mm());
  EXPECT_GT(error_of_slices(1.0, 3.0).standard_error_mm(), error_of_slices(1.0).standard_error_mm());
  EXPECT_GT(error_of_slices(1.0, 5.0).standard_error_mm(), error_of_slices(4.0, 4.0).standard_error_mm());
}

TEST(CtSurfaceError, TurnsWithTheGrid) {
  Mat3 turned;  // slices that face to the patient's left
  turned << 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  const CtSurfaceError plain = error_of_slices(3.0);
  const CtSurfaceError other = ct_surface_error(12.0, {Vec3(0.7, 0.7, 3.0), 0.0, turned}, kSlopes, kAllSides);
  EXPECT_DOUBLE_EQ(other.standard_error_mm(Vec3::UnitX()), plain.standard_error_mm(Vec3::UnitZ()));
  EXPECT_DOUBLE_EQ(other.standard_error_mm(Vec3::UnitZ()), plain.standard_error_mm(Vec3::UnitY()));
}

TEST(CtSurfaceError, HasABandOfItsWallOrOfAll) {
  const CtSurfaceError error = error_of_slices(3.0);
  const Interval across = error.band(1.0, Vec3::UnitZ()), all = error.band(1.0);
  EXPECT_NEAR(1.0 - across.low, 1.95996 * error.standard_error_mm(Vec3::UnitZ()), 1e-4);
  EXPECT_NEAR(all.high - 1.0, 1.95996 * error.standard_error_mm(), 1e-4);
  // Root mean square over the sides that were given.
  double squares = 0.0;
  for (const Vec3& side : kAllSides) squares += std::pow(error.standard_error_mm(side), 2) / 3.0;
  EXPECT_NEAR(error.standard_error_mm(), std::sqrt(squares), 1e-12);
  EXPECT_THROW(error.band(1.0, Vec3::UnitZ(), 1.0), Error);
}

TEST(CtSurfaceError, RejectsWhatMakesNoSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const CtSampling fine{Vec3(0.7, 0.7, 1.0)};
  EXPECT_THROW(ct_surface_error(nan, fine, kSlopes, kAllSides), Error);
  EXPECT_THROW(ct_surface_error(12.0, {Vec3(0.7, 0.0, 1.0)}, kSlopes, kAllSides), Error);
  EXPECT_THROW(ct_surface_error(12.0, {Vec3(0.7, 0.7, 1.0), -1.0}, kSlopes, kAllSides), Error);
  EXPECT_THROW(ct_surface_error(12.0, {Vec3(0.7, 0.7, 1.0), nan}, kSlopes, kAllSides), Error);
  EXPECT_THROW(ct_surface_error(12.0, fine, {}, kAllSides), Error);
  EXPECT_THROW(ct_surface_error(12.0, fine, kSlopes, {}), Error);
  EXPECT_THROW(ct_surface_error(12.0, fine, std::vector<double>{-1.0}, kAllSides), Error);
}

}  // namespace
}  // namespace spinaltap
