#include "core/segment/spine_column.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr double kArcMm = 250.0;  // radius of the column's bend, as of a kyphosis of 40 degrees over 175 mm

/// A place on a column that bends forward, `s_mm` above its middle, with its axes.
BodyCylinder on_arc(double s_mm, const Vec3& half_mm) {
  const double turn = s_mm / kArcMm;
  Mat3 axes;
  axes.col(0) = Vec3::UnitX();
  axes.col(2) = Vec3(0.0, -std::sin(turn), std::cos(turn));
  axes.col(1) = axes.col(2).cross(axes.col(0));
  BodyCylinder body;
  body.centre_mm = Vec3(0.0, -kArcMm * (1.0 - std::cos(turn)), kArcMm * std::sin(turn));
  body.half_mm = half_mm;
  body.set_axes(axes);
  return body;
}

class ColumnThrough : public ::testing::Test {
 protected:
  FloatGrid air_ = [] {
    FloatGrid grid;
    grid.geometry.size = {4, 4, 4};
    grid.values.assign(64, 0.0F);
    return grid;
  }();
  WallProbe probe_{air_, {}};
};

TEST_F(ColumnThrough, FollowsTheBodiesAndBendsOnBeyondThem) {
  // The one at 30 mm is missing.
  const std::vector<BodyCylinder> bodies{on_arc(-60.0, Vec3(20.0, 16.0, 12.0)), on_arc(-30.0, Vec3(20.0, 16.0, 12.0)),
                                         on_arc(0.0, Vec3(20.0, 16.0, 12.0)), on_arc(60.0, Vec3(16.0, 14.0, 11.0))};
  constexpr double kBeyondMm = 40.0;
  const SpineColumn column = column_through(bodies, kBeyondMm, probe_);
  EXPECT_NEAR(column.length_mm(), 120.0 + 2.0 * kBeyondMm, 2.0 * SpineColumn::kStepMm);
  for (std::size_t n = 0; n < column.sections.size(); ++n) {
    const ColumnSection& section = column.sections[n];
    const double s_mm = SpineColumn::kStepMm * static_cast<double>(n) - 60.0 - kBeyondMm;
    const BodyCylinder ground_truth = on_arc(s_mm, Vec3::Ones());
    EXPECT_LT((section.centre_mm - ground_truth.centre_mm).head<2>().norm(), 0.6) << "at " << s_mm << " mm";
    EXPECT_LT((section.centre_mm - ground_truth.centre_mm).norm(), 1.5)
        << "at " << s_mm << " mm";  // as even as the steps
    EXPECT_GT(section.axes.col(2).dot(ground_truth.axes().col(2)), std::cos(1.0 * kDegree)) << "at " << s_mm << " mm";
  }
  EXPECT_NEAR(column.at(40.0 + 90.0).half_width_mm, 18.0, 0.3);  // halfway from the third to the fourth
  EXPECT_NEAR(column.at(40.0 + 90.0).half_depth_mm, 15.0, 0.3);
}

TEST_F(ColumnThrough, NeedsTwoBodies) {
  EXPECT_THROW(column_through({on_arc(0.0, Vec3(20.0, 16.0, 12.0))}, 40.0, probe_), Error);
}

}  // namespace
}  // namespace spinaltap
