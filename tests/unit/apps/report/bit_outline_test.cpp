#include "apps/report/bit_outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace spinaltap {
namespace {

/// 1 pixel is 1 mm, pixel (0, 0) at the origin, seen along z.
SliceFrame unit_frame() { return {.pixel_mm = 1.0, .width = 100, .height = 100}; }

double area(const PixelPolygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * std::abs(twice);
}

/// Extent of the polygon along a direction.
double extent(const PixelPolygon& polygon, const Eigen::Vector2d& direction) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Eigen::Vector2d& p : polygon) {
    low = std::min(low, p.dot(direction));
    high = std::max(high, p.dot(direction));
  }
  return high - low;
}

/// Of a drill, which is convex, there is one part.
PixelPolygon only(const std::vector<PixelPolygon>& polygons) {
  EXPECT_EQ(polygons.size(), 1U);
  return polygons.empty() ? PixelPolygon{} : polygons.front();
}

TEST(BitOutline, CutsTheShaftInTheEllipseOfACylinder) {
  const DrillBit bit{4.0, 60.0, 5.0};
  for (const double angle : {0.0, 0.3, 0.8, 1.2}) {  // between the axis and the plane's normal
    const Vec3 axis(std::sin(angle), 0.0, std::cos(angle));
    const Pose pose{30.0 * axis, axis};  // the axis passes the origin in the middle of the shaft
    const PixelPolygon section = only(bit_section(unit_frame(), bit, pose));
    // A polygon of 96 corners in an ellipse: short of it by 0.06% of each half axis, 0.08% of the area.
    EXPECT_NEAR(extent(section, {0, 1}), 4.0, 0.0025) << angle;
    EXPECT_NEAR(extent(section, {1, 0}), 4.0 / std::cos(angle), 0.0025 / std::cos(angle)) << angle;
    const double ellipse = std::numbers::pi * 2.0 * 2.0 / std::cos(angle);
    EXPECT_NEAR(area(section), ellipse, 0.001 * ellipse) << angle;
  }
}

TEST(BitOutline, CutsTheConeInASmallerCircle) {
  const DrillBit bit{4.0, 60.0, 5.0};
  const PixelPolygon section = only(bit_section(unit_frame(), bit, {Vec3(0, 0, 2.0), Vec3::UnitZ()}));
  EXPECT_NEAR(extent(section, {1, 0}), 4.0 * 2.0 / 5.0, 0.002);  // 2 mm behind the tip
}

TEST(BitOutline, ShowsTheFullOutlineInAPlaneThatHoldsTheAxis) {
  const DrillBit bit{3.0, 50.0, 5.0};
  for (const double turn : {0.0, 0.7, 2.0}) {
    const Vec3 axis(std::cos(turn), std::sin(turn), 0.0);
    const Pose pose{Vec3(20, 30, 0), axis};
    const double expected = 45.0 * 3.0 + 0.5 * 5.0 * 3.0;  // shaft and cone
    for (const PixelPolygon& outline :
         {only(bit_section(unit_frame(), bit, pose)), only(bit_projection(unit_frame(), bit, pose))}) {
      EXPECT_NEAR(area(outline), expected, 0.002 * expected) << turn;
      EXPECT_NEAR(extent(outline, axis.head<2>()), 50.0, 1e-6) << turn;
    }
  }
}

TEST(BitOutline, CutsARectangleBesideTheAxis) {
  const DrillBit bit{4.0, 60.0, 5.0};
  const Pose pose{Vec3(0, 0, 1.2), Vec3::UnitX()};
  const PixelPolygon section = only(bit_section(unit_frame(), bit, pose));
  EXPECT_NEAR(extent(section, {0, 1}), 2.0 * std::sqrt(2.0 * 2.0 - 1.2 * 1.2), 0.006);
  // A plane 1.2 mm off the axis meets the cone where its radius is 1.2 mm, 3 mm behind the tip.
  EXPECT_NEAR(extent(section, {1, 0}), 57.0, 0.02);
}

TEST(BitOutline, ProjectsTheBitOntoPlanesItDoesNotReach) {
  const DrillBit bit{4.0, 60.0, 5.0};
  const Pose pose{Vec3(10, 10, 80), Vec3::UnitX()};
  EXPECT_TRUE(bit_section(unit_frame(), bit, pose).empty());
  EXPECT_NEAR(extent(only(bit_projection(unit_frame(), bit, pose)), {1, 0}), 60.0, 1e-9);
}

TEST(BitOutline, ShowsABurrsBallAndShankBesideEachOther) {
  DrillBit bit{6.0, 40.0, 0.0, BitShape::round_burr};
  bit.shank_diameter_mm = 2.0;
  const Pose pose{Vec3(50, 30, 0), Vec3::UnitX()};
  const double neck_mm = 3.0 + std::sqrt(8.0);  // where the ball of 3 mm is 1 mm wide
  for (const auto& parts : {bit_section(unit_frame(), bit, pose), bit_projection(unit_frame(), bit, pose)}) {
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_NEAR(extent(parts[0], {1, 0}), neck_mm, 1e-9);
    EXPECT_NEAR(extent(parts[0], {0, 1}), 6.0, 0.02);
    EXPECT_NEAR(extent(parts[1], {1, 0}), 40.0 - neck_mm, 1e-9);
    EXPECT_NEAR(extent(parts[1], {0, 1}), 2.0, 1e-9);
  }
  // A plane across the shank misses the ball.
  const auto across = bit_section(unit_frame(), bit, {Vec3(40, 40, 20), Vec3::UnitZ()});
  ASSERT_EQ(across.size(), 1U);
  EXPECT_NEAR(extent(across[0], {1, 0}), 2.0, 0.002);
}

TEST(BitOutline, OfAPlateIsItsBoxCutAndProjected) {
  const DrillBit plate = plate_bit(12.0, 1.5, 60.0);
  for (const double turn : {0.0, 0.4}) {
    const Vec3 side(std::cos(turn), std::sin(turn), 0.0);
    // Across: width x thickness, turned with the side.
    const PixelPolygon across = only(bit_section(unit_frame(), plate, {Vec3(40, 40, 20), Vec3::UnitZ(), side}));
    EXPECT_EQ(across.size(), 4U);
    EXPECT_NEAR(area(across), 12.0 * 1.5, 1e-9);
    EXPECT_NEAR(extent(across, side.head<2>()), 12.0, 1e-9);
  }
  // Along its width: width x length; along its thickness: thickness x length.
  const Pose flat{Vec3(40, 40, 0), Vec3::UnitY(), Vec3::UnitX()},
      upright{Vec3(40, 40, 0), Vec3::UnitY(), Vec3::UnitZ()};
  EXPECT_NEAR(area(only(bit_section(unit_frame(), plate, flat))), 12.0 * 60.0, 1e-9);
  EXPECT_NEAR(area(only(bit_section(unit_frame(), plate, upright))), 1.5 * 60.0, 1e-9);
  EXPECT_NEAR(area(only(bit_projection(unit_frame(), plate, upright))), 1.5 * 60.0, 1e-9);
  // Slanting by 30 degrees the section is longer by 1 / cos.
  const Vec3 axis(std::sin(kDegree * 30.0), 0.0, std::cos(kDegree * 30.0));
  const PixelPolygon slant = only(bit_section(unit_frame(), plate, {30.0 * axis, axis, Vec3::UnitY()}));
  EXPECT_NEAR(area(slant), 12.0 * 1.5 / axis.z(), 1e-9);
  // Away from the plane it has a projection alone.
  const Pose away{Vec3(40, 40, 30), Vec3::UnitY(), Vec3::UnitX()};
  EXPECT_TRUE(bit_section(unit_frame(), plate, away).empty());
  EXPECT_NEAR(area(only(bit_projection(unit_frame(), plate, away))), 12.0 * 60.0, 1e-9);
}

}  // namespace
}  // namespace spinaltap
