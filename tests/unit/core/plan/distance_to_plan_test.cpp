#include "core/plan/distance_to_plan.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <numbers>

namespace spinaltap {
namespace {

DrillPath path_along(const Vec3& entry_mm, const Vec3& direction, double length_mm) {
  DrillPath path;
  path.entry_mm = entry_mm;
  path.target_mm = entry_mm + length_mm * direction.normalized();
  return path;
}

TEST(DistanceToPlan, IsNothingOnThePath) {
  const PathCurve path(path_along({10.0, -20.0, 30.0}, {1.0, 2.0, -2.0}, 40.0));
  for (const double depth_mm : {-7.0, 0.0, 12.5, 40.0, 44.0}) {
    const DistanceToPlan distance = distance_to_plan(path, path.pose_at(depth_mm));
    EXPECT_NEAR(distance.at_tip_mm.norm(), 0.0, 1e-12);
    EXPECT_NEAR(distance.at_entry_mm.norm(), 0.0, 1e-12);
    EXPECT_NEAR(distance.at_target_mm.norm(), 0.0, 1e-12);
    EXPECT_NEAR(distance.angle_deg, 0.0, 1e-12);
    EXPECT_NEAR(distance.depth_mm, depth_mm, 1e-12);
    EXPECT_NEAR(distance.left_mm, 40.0 - depth_mm, 1e-12);
  }
}

// A triangle: the tip is `aside` from the path at depth s, the tool leans over by an angle a in a plane through it. Its
// axis then is s tan(a) away from there at the entry, (length - s) tan(a) on the other side at the target.
TEST(DistanceToPlan, IsThatOfTheTriangleOfALeaningTool) {
  for (const Vec3& direction : {Vec3(0.0, 0.0, 1.0), Vec3(-0.3, 0.9, 0.1), Vec3(0.0, -1.0, 0.0)}) {
    const double length_mm = 45.0;
    const PathCurve path(path_along({-5.0, 8.0, 1000.0}, direction, length_mm));
    const Mat3 axes = path.axes_at(0.0);
    for (const double angle_deg : {0.001, 1.0, 7.0, 30.0, 80.0}) {
      for (const double turn : {0.0, 1.0, 2.5, 4.0}) {
        const double depth_mm = 17.0, slope = std::tan(angle_deg * kDegree);
        const Eigen::Vector2d aside_mm(0.7, -1.9), lean(std::cos(turn), std::sin(turn));
        const Vec3 axis = Vec3(slope * lean.x(), slope * lean.y(), 1.0).normalized();
        const Pose tool{path.to_patient({aside_mm.x(), aside_mm.y(), depth_mm}), axes * axis};
        const DistanceToPlan distance = distance_to_plan(path, tool);
        EXPECT_NEAR(distance.depth_mm, depth_mm, 1e-9);
        EXPECT_NEAR(distance.left_mm, length_mm - depth_mm, 1e-9);
        EXPECT_NEAR(distance.angle_deg, angle_deg, 1e-7);
        EXPECT_NEAR((distance.at_tip_mm - aside_mm).norm(), 0.0, 1e-9);
        EXPECT_NEAR((distance.at_entry_mm - (aside_mm - depth_mm * slope * lean)).norm(), 0.0, 1e-9);
        EXPECT_NEAR((distance.at_target_mm - (aside_mm + (length_mm - depth_mm) * slope * lean)).norm(), 0.0, 1e-9);
      }
    }
  }
}

// Along an arc of a circle of radius R, a tool that keeps to the tangent of a place at angle t has come R t deep and
// would miss the target, 90 degrees on, where its line meets the target's radius.
TEST(DistanceToPlan, FollowsACurvedPath) {
  const double radius_mm = 60.0, whole = 0.6;
  const auto on_arc = [&](double t) { return Vec3(radius_mm * (1.0 - std::cos(t)), 0.0, radius_mm * std::sin(t)); };
  DrillPath drawn = path_along(on_arc(0.0), on_arc(whole), on_arc(whole).norm());
  drawn.target_mm = on_arc(whole);
  for (int n = 1; n < 24; ++n) drawn.via_mm.push_back(on_arc(whole * n / 24.0));
  const PathCurve path(drawn);
  const double t = 0.3, aside_mm = 1.5;
  const Vec3 outwards(-std::cos(t), 0.0, std::sin(t)), tangent(std::sin(t), 0.0, std::cos(t));
  const DistanceToPlan distance = distance_to_plan(path, {on_arc(t) + aside_mm * outwards, tangent});
  // A natural spline through points 1.5 mm apart is straight at its ends, and within micrometres elsewhere.
  EXPECT_NEAR(distance.depth_mm, radius_mm * t, 0.01);
  EXPECT_NEAR(distance.left_mm, radius_mm * (whole - t), 0.01);
  EXPECT_NEAR(distance.at_tip_mm.norm(), aside_mm, 0.002);
  EXPECT_NEAR(distance.angle_deg, 0.0, 0.02);
  // From the middle of the circle the line is R + aside away where it touches, and that over cos(whole - t) at the
  // target's radius.
  const double miss_mm = (radius_mm + aside_mm) / std::cos(whole - t) - radius_mm;
  EXPECT_NEAR(distance.at_target_mm.norm(), miss_mm, 0.1);
}

TEST(DistanceToPlan, OfAToolThatPointsAwaySaysNoCrossing) {
  const PathCurve path(path_along(Vec3::Zero(), Vec3::UnitZ(), 30.0));
  const DistanceToPlan across = distance_to_plan(path, {Vec3(1.0, 0.0, 5.0), Vec3::UnitX()});
  EXPECT_NEAR(across.angle_deg, 90.0, 1e-9);
  EXPECT_TRUE(across.at_entry_mm.hasNaN());
  EXPECT_TRUE(across.at_target_mm.hasNaN());
  EXPECT_NEAR(across.at_tip_mm.norm(), 1.0, 1e-12);
  EXPECT_NEAR(distance_to_plan(path, {Vec3::Zero(), -Vec3::UnitZ()}).angle_deg, 180.0, 1e-9);
  const DistanceToPlan none =
      distance_to_plan(path, {Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), Vec3::UnitZ()});
  EXPECT_TRUE(std::isnan(none.left_mm));
  EXPECT_TRUE(std::isnan(none.angle_deg));
}

}  // namespace
}  // namespace spinaltap
