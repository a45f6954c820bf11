#include "apps/report/bone_outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/report/slice_figure.h"
#include "tests/support/analytic_bodies.h"

namespace spinaltap {
namespace {

const test::Ball kOutlinedBall{Vec3(40.0, -25.0, 310.0), 11.0};

OutlinedBone ball_to_outline(double band_mm) {
  return {[band_mm](std::span<const Vec3> places, std::span<float> distances) {
    for (std::size_t n = 0; n < places.size(); ++n) {
      distances[n] = static_cast<float>(std::clamp(kOutlinedBall.distance_mm(places[n]), -band_mm, band_mm));
    }
  }};
}

SliceFrame frame_through(const Vec3& through_mm) {
  return plane_frame(Plane::kAxial, through_mm,
                     Box3(through_mm - Vec3::Constant(15.0), through_mm + Vec3::Constant(15.0)), 0.2);
}

double length_of(const OutlineRun& run) {
  double length = 0.0;
  for (std::size_t n = 1; n < run.points.size(); ++n) length += (run.points[n] - run.points[n - 1]).norm();
  if (run.is_closed) length += (run.points.front() - run.points.back()).norm();
  return length;
}

TEST(BoneOutline, OfABallIsACircle) {
  for (const double above_mm : {0.0, 4.0, 10.0}) {
    const Vec3 through_mm = kOutlinedBall.centre_mm + Vec3(0.0, 0.0, above_mm);
    const SliceFrame frame = frame_through(through_mm);
    const std::vector<OutlineRun> runs = bone_outline(ball_to_outline(0.75), frame);
    ASSERT_EQ(runs.size(), 1U);
    EXPECT_TRUE(runs[0].is_closed);
    const double radius_mm = std::sqrt(121.0 - above_mm * above_mm);
    for (const Eigen::Vector2d& p : runs[0].points) {
      // Between nodes 0.25 mm apart a straight line stands for a curve: h² / (8 r) = 0.002 mm at r = 4.6 mm.
      const Vec3 place = frame.to_patient(Vec3(p.x(), p.y(), 0.0));
      EXPECT_NEAR((place - through_mm).norm(), radius_mm, 0.005);
    }
    // Thinned to chords that are 0.02 mm off at most: shorter than the circle by at most 8/3 of that over a chord's
    // half.
    EXPECT_NEAR(length_of(runs[0]) * 0.2, 2.0 * std::numbers::pi * radius_mm, 0.1);
  }
}

TEST(BoneOutline, EndsAtThePicturesBorder) {
  SliceFrame frame = frame_through(kOutlinedBall.centre_mm);
  frame.width /= 2;  // the right half of the ball is not in it
  const std::vector<OutlineRun> runs = bone_outline(ball_to_outline(0.75), frame);
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_FALSE(runs[0].is_closed);
  for (const Eigen::Vector2d& end : {runs[0].points.front(), runs[0].points.back()}) {
    EXPECT_NEAR(end.x(), frame.width - 0.5, 1e-9);
  }
}

TEST(BoneOutline, IsNothingWhereThePlaneMissesTheBone) {
  EXPECT_TRUE(bone_outline(ball_to_outline(0.75), frame_through(kOutlinedBall.centre_mm + Vec3(0, 0, 11.5))).empty());
}

TEST(BoneOutline, PartsWhereTheCanalsWallBegins) {
  OutlinedBone bone = ball_to_outline(0.75);
  bone.is_canal_wall = [](const Vec3& p) { return p.x() > kOutlinedBall.centre_mm.x() + 5.5; };
  const SliceFrame frame = frame_through(kOutlinedBall.centre_mm);
  const std::vector<OutlineRun> runs = bone_outline(bone, frame);
  ASSERT_EQ(runs.size(), 2U);
  double whole = 0.0;
  for (const OutlineRun& run : runs) {
    EXPECT_FALSE(run.is_closed);
    whole += 0.2 * length_of(run);
    // A chord at half the radius cuts off a third of the circle; a run goes on to the next one's first point.
    if (!run.is_canal) continue;
    EXPECT_NEAR(0.2 * length_of(run), 2.0 * std::numbers::pi * 11.0 / 3.0, 0.8);
  }
  EXPECT_NEAR(whole, 2.0 * std::numbers::pi * 11.0, 0.1);
}

TEST(BoneOutline, PartsASaddleByItsMean) {
  // x y - 0.01: a hyperbola about a node in the middle of the sheet; its two branches never touch.
  OutlinedBone bone{[](std::span<const Vec3> places, std::span<float> distances) {
    for (std::size_t n = 0; n < places.size(); ++n) {
      distances[n] = static_cast<float>(places[n].x() * places[n].y() - 0.01);
    }
  }};
  const SliceFrame frame{.origin_mm = Vec3(-1.9, -1.9, 0.0), .pixel_mm = 0.2, .width = 20, .height = 20};
  const std::vector<OutlineRun> runs = bone_outline(bone, frame);
  ASSERT_EQ(runs.size(), 2U);
  for (const OutlineRun& run : runs) {
    EXPECT_FALSE(run.is_closed);
    for (const Eigen::Vector2d& p : run.points) {
      const Vec3 place = frame.to_patient(Vec3(p.x(), p.y(), 0.0));
      EXPECT_GT(place.x() * place.y(), 0.0);
      EXPECT_EQ(place.x() > 0.0, frame.to_patient(Vec3(run.points[0].x(), run.points[0].y(), 0.0)).x() > 0.0);
    }
  }
}

TEST(CrossFrame, LooksAlongThePathFromBehind) {
  const DrillPath path{"left", Vec3(20.0, 30.0, 5.0), Vec3(10.0, -10.0, 8.0), {}};
  const SliceFrame frame = cross_frame(path, 12.0, {30.0, 40.0}, 0.1);
  EXPECT_EQ(frame.width, 300);
  EXPECT_EQ(frame.height, 400);
  EXPECT_NEAR((frame.into() - path.direction()).norm(), 0.0, 1e-12);
  EXPECT_LT(frame.right.x(), -0.9) << "the patient's right is on the right";
  EXPECT_LT(frame.down.z(), -0.9);
  const Vec3 middle = frame.to_patient(Vec3(149.5, 199.5, 0.0));
  EXPECT_NEAR((middle - path.entry_mm - 12.0 * path.direction()).norm(), 0.0, 1e-9);
}

}  // namespace
}  // namespace spinaltap
