#include "core/tool/path_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace spinaltap {
namespace {

/// Places on a circle in a tilted plane, `count` between entry and target, from -half to +half its arc's angle.
struct Circle {
  Vec3 centre_mm{31.0, 212.0, -618.0};
  Vec3 x = Vec3(1.0, 2.0, -0.5).normalized();
  Vec3 y = x.cross(Vec3(0.3, -0.2, 0.9)).normalized();
  double radius_mm = 30.0;

  Vec3 at(double angle) const { return centre_mm + radius_mm * (std::sin(angle) * x + std::cos(angle) * y); }
  DrillPath path(double half, int count) const {
    DrillPath path{"arc", at(-half), at(half), steerable_head()};
    for (int n = 1; n <= count; ++n) path.via_mm.push_back(at(half * (2.0 * n / (count + 1) - 1.0)));
    return path;
  }
  /// How far a place is off the circle.
  double off_mm(const Vec3& p_mm) const {
    const Vec3 from_mm = p_mm - centre_mm;
    return std::hypot(from_mm.dot(x.cross(y)), std::hypot(from_mm.dot(x), from_mm.dot(y)) - radius_mm);
  }
};

TEST(PathCurve, IsExactlyTheLineWithoutPlacesBetween) {
  const DrillPath path{"line", {19.3, 36.0, 2.6}, {10.6, -5.1, 2.61}, {}};
  const PathCurve curve(path);
  EXPECT_TRUE(curve.is_straight());
  EXPECT_EQ(curve.length_mm(), (path.target_mm - path.entry_mm).norm());
  EXPECT_EQ(path.length_mm(), curve.length_mm());
  const Vec3 p_mm(14.0, 20.0, 7.0);
  EXPECT_EQ(curve.nearest_mm(p_mm), (p_mm - path.entry_mm).dot(path.direction()));
  for (const double along_mm : {-3.0, 0.0, 0.1, 17.3, curve.length_mm(), 60.0}) {
    EXPECT_EQ(curve.at_mm(along_mm), Vec3(path.entry_mm + along_mm * path.direction()));
    EXPECT_EQ(curve.direction_at(along_mm), path.direction());
    EXPECT_EQ(curve.axes_at(along_mm), PathFrame(path.entry_mm, path.direction()).axes());
  }
  EXPECT_EQ(curve.min_radius_mm(), std::numeric_limits<double>::infinity());
}

// A natural spline misses a circle's curvature k at its ends only: there it is off by the cubic with that second
// derivative at one end, at most 0.064 k h² between places h apart, and by 0.27 of that in the next interval, and so
// on; away from the ends by h⁴ k³ / 384 and less.
TEST(PathCurve, FollowsACircleThroughItsPlaces) {
  const Circle circle;
  const double half = 0.6;
  for (const int count : {1, 3, 7}) {
    const PathCurve curve(circle.path(half, count));
    const double apart_mm = 2.0 * circle.radius_mm * std::sin(half / (count + 1));
    const double bound_mm = 0.08 * apart_mm * apart_mm / circle.radius_mm;
    double max_mm = 0.0, middle_mm = 0.0;
    for (double share = 0.0; share <= 1.0; share += 0.001) {
      const double off_mm = circle.off_mm(curve.at_mm(share * curve.length_mm()));
      max_mm = std::max(max_mm, off_mm);
      if (std::abs(share - 0.5) < 0.1) middle_mm = std::max(middle_mm, off_mm);
    }
    EXPECT_LT(max_mm, bound_mm) << count;
    if (count == 7) {
      EXPECT_LT(middle_mm, 2e-3);
    }
    if (count == 7) {
      EXPECT_NEAR(curve.length_mm(), 2.0 * half * circle.radius_mm, 5e-3);
    }
  }
}

// Through (-a, 0), (0, b), (a, 0) the spline is x = a t, y = b (3 (t+1) - (t+1)³) / 2 for t from -1 to 0, and its
// mirror image. Its length is one integral, taken here by Simpson's rule in a hundred thousand steps.
TEST(PathCurve, IsMeasuredByItsArc) {
  for (const double b : {0.5, 4.0, 12.0}) {
    const double a = 15.0;
    DrillPath path{"hill", {-a, 0.0, 5.0}, {a, 0.0, 5.0}, steerable_head()};
    path.via_mm = {{0.0, b, 5.0}};
    const PathCurve curve(path);
    const auto speed = [&](double t) { return std::hypot(a, 1.5 * b * (1.0 - t * t)); };
    const int steps = 100'000;
    double sum = speed(0.0) + speed(1.0);
    for (int n = 1; n < steps; ++n) sum += (n % 2 == 1 ? 4.0 : 2.0) * speed(static_cast<double>(n) / steps);
    EXPECT_NEAR(curve.length_mm(), 2.0 * sum / (3.0 * steps), 1e-7);
    for (const double x : {-14.0, -6.0, -0.5}) {
      const double t = x / a + 1.0;
      const double tangent = std::atan2(1.5 * b * (1.0 - t * t), a);
      const double along_mm = curve.nearest_mm({x, 0.5 * b * (3.0 * t - t * t * t), 5.0});
      EXPECT_NEAR(curve.at_mm(along_mm).x(), x, 1e-6);
      EXPECT_NEAR(curve.at_mm(along_mm).y(), 0.5 * b * (3.0 * t - t * t * t), 1e-6);
      EXPECT_NEAR((curve.direction_at(along_mm) - Vec3(std::cos(tangent), std::sin(tangent), 0.0)).norm(), 0.0, 1e-6);
    }
    // y'' = -3 b / a² at the top, where it is tightest: there the curve runs level.
    EXPECT_NEAR(curve.min_radius_mm(), a * a / (3.0 * b), 0.01 * curve.min_radius_mm());
  }
}

/// A curve that winds out of its plane.
DrillPath winding() {
  DrillPath path{"winding", {10.0, 40.0, 3.0}, {2.0, -2.0, 6.0}, {1.0, 1.0, 0.5, BitShape::round_burr}};
  path.via_mm = {{12.0, 30.0, 6.0}, {9.0, 20.0, 2.0}, {5.0, 10.0, 4.0}};
  return path;
}

TEST(PathCurve, GoesItsLengthWithUnitTangentsAndAxesThatDoNotTwist) {
  const DrillPath path = winding();
  check_path(path);
  const PathCurve curve(path);
  const double step_mm = 0.01;
  for (double s = -2.0; s < curve.length_mm() + 2.0; s += step_mm) {
    const Vec3 way_mm = curve.at_mm(s + step_mm) - curve.at_mm(s);
    // An arc of a radius r is longer than its chord by step³ / 24 r².
    ASSERT_NEAR(way_mm.norm(), step_mm, 1e-8) << s;
    ASSERT_NEAR(curve.direction_at(s).norm(), 1.0, 1e-12);
    ASSERT_LT((way_mm / step_mm - curve.direction_at(s + 0.5 * step_mm)).norm(), 1e-5) << s;
    const Mat3 axes = curve.axes_at(s), next = curve.axes_at(s + step_mm);
    ASSERT_LT((axes.transpose() * axes - Mat3::Identity()).norm(), 1e-9);
    // Their change is along the path only. Its rate is the curvature, and the double reflection is exact to its cube.
    ASSERT_LT(std::abs((next.col(0) - axes.col(0)).dot(axes.col(1))) / step_mm, 1e-4) << s;
    ASSERT_LT((axes.col(2) - curve.direction_at(s)).norm(), 1e-12);
  }
  EXPECT_LT((curve.at_mm(curve.length_mm()) - path.target_mm).norm(), 1e-9);
  for (const Vec3& via_mm : path.via_mm) EXPECT_LT((curve.at_mm(curve.nearest_mm(via_mm)) - via_mm).norm(), 1e-6);
}

TEST(PathCurve, FindsTheNearestPlaceOfItsLength) {
  const PathCurve curve(winding());
  for (double s = -5.0; s < curve.length_mm() + 5.0; s += 0.37) {
    for (const double turn : {0.0, 2.0, 4.0}) {
      const double aside_mm = 0.5 * std::min(curve.min_radius_mm(), 8.0);
      const Vec3 p_mm = curve.to_patient({aside_mm * std::cos(turn), aside_mm * std::sin(turn), s});
      ASSERT_NEAR(curve.nearest_mm(p_mm), s, 1e-5) << s;
    }
  }
}

TEST(PathCurve, TellsWhereItLiesAboutItsChord) {
  const Circle circle;
  const double half = 0.5;
  const DrillPath path = circle.path(half, 15);
  const PathCurve curve(path);
  const PathCurve::AboutChord about = curve.about_chord(0.0, curve.length_mm());
  EXPECT_NEAR(about.off_mm, circle.radius_mm * (1.0 - std::cos(half)), 1e-2);
  EXPECT_NEAR(about.low_mm, 0.0, 1e-9);
  EXPECT_NEAR(about.high_mm, path.chord_mm(), 1e-9);
  // Where the circle's curvature k is missed at an end, its slope is by k h / (2 sqrt(3)) between places h apart.
  const double missed = 2.0 * half / 16.0 / (2.0 * std::numbers::sqrt3);
  EXPECT_NEAR(curve.max_tilt_deg(), (half - missed) / kDegree, 0.02);
}

std::string complaint(const DrillPath& path) {
  try {
    check_path(path);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(PathCurve, IsRejectedWhereNoToolCanGoIt) {
  const Circle circle;
  const DrillPath good = circle.path(0.5, 5);
  EXPECT_EQ(complaint(good), "");
  DrillPath bad = good;
  bad.via_mm[2].x() = std::nan("");
  EXPECT_NE(complaint(bad).find("finite"), std::string::npos);
  bad = good;
  bad.via_mm[2] = bad.via_mm[1] + Vec3(0.05, 0.0, 0.0);
  EXPECT_NE(complaint(bad).find("0.1 mm apart"), std::string::npos);
  EXPECT_NE(complaint(circle.path(0.5, 33)).find("up to 32 places"), std::string::npos);
  EXPECT_EQ(complaint(circle.path(0.5, 32)), "");
  EXPECT_NE(complaint(circle.path(1.8, 20)).find("goes on from entry to target"), std::string::npos);
  bad = good;
  bad.screw = PedicleScrew{};
  EXPECT_NE(complaint(bad).find("screws are straight"), std::string::npos);
  Circle tight;
  tight.radius_mm = 1.2;
  EXPECT_NE(complaint(tight.path(0.9, 5)).find("bends wider than the bit's radius"), std::string::npos);
  EXPECT_THROW(check_straight(good, "a rod"), Error);
  EXPECT_NO_THROW(check_straight({"line", {0.0, 0.0, 0.0}, {0.0, 0.0, 9.0}, {}}, "a rod"));
}

// A cylinder of length l whose end follows a circle of radius r stands out at its other end by sqrt(r² + l²) - r.
TEST(PathCurve, IsRejectedForABitThatItsBendsAreTooTightFor) {
  const Circle circle;
  DrillPath path = circle.path(0.5, 15);
  const double tightest_mm = PathCurve(path).min_radius_mm();
  const double longest_mm =
      std::sqrt((tightest_mm + kMaxStandOutMm) * (tightest_mm + kMaxStandOutMm) - tightest_mm * tightest_mm);
  path.bit = {3.0, longest_mm - 1e-3, 1.0};
  EXPECT_EQ(complaint(path), "");
  path.bit.length_mm = longest_mm + 1e-3;
  EXPECT_NE(complaint(path).find("bit short enough for its bends"), std::string::npos);
  path.bit = {};
  EXPECT_NE(complaint(path).find("50 mm"), std::string::npos);
}

}  // namespace
}  // namespace spinaltap
