// Compiled with optimisation: long loops of its own.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/error.h"
#include "core/tool/bit_profile.h"
#include "tests/unit/core/engine/tools.h"

namespace spinaltap {
namespace {

using test::Draw;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;
using Vec2 = Eigen::Vector2d;

const std::vector<OutlinePoint> kMatchHead{{0.0, 0.0},  {1.5, 1.5, true}, {3.8, 1.5}, {4.6, 0.9},
                                           {12.0, 0.9}, {14.0, 1.2},      {60.0, 1.2}};

/// The outline as its places say it, from the tip to the axis at the base, at most `step_mm` apart: arcs by even angles
/// about the place of the axis that is as far from both ends.
std::vector<Vec2> polyline(const std::vector<OutlinePoint>& outline, double step_mm) {
  std::vector<Vec2> line{{0.0, 0.0}};
  const auto go = [&](const Vec2& to) {
    const Vec2 from = line.back();
    const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / step_mm)));
    for (int n = 1; n <= steps; ++n) line.push_back(from + static_cast<double>(n) / steps * (to - from));
  };
  for (const OutlinePoint& point : outline) {
    const Vec2 from = line.back(), to(point.back_mm, point.radius_mm);
    if (!point.is_arc) {
      go(to);
      continue;
    }
    // Half-way between the ends, at right angles to their line, down to the axis.
    const Vec2 middle = 0.5 * (from + to), along = to - from;
    const double centre_mm = middle.x() + middle.y() * along.y() / along.x();
    const double radius_mm = std::hypot(from.x() - centre_mm, from.y());
    const double first = std::atan2(from.y(), from.x() - centre_mm), last = std::atan2(to.y(), to.x() - centre_mm);
    const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(first - last) * radius_mm / step_mm)));
    for (int n = 1; n <= steps; ++n) {
      const double angle = first + (last - first) * n / steps;
      line.emplace_back(centre_mm + radius_mm * std::cos(angle), radius_mm * std::sin(angle));
    }
  }
  go({outline.back().back_mm, 0.0});
  return line;
}

/// Whether a place lies between the polyline and the axis: a ray outwards crosses the line an odd number of times.
bool is_below(const std::vector<Vec2>& line, const Vec2& q) {
  int crossings = 0;
  for (std::size_t n = 1; n < line.size(); ++n) {
    const Vec2 &a = line[n - 1], &b = line[n];
    if ((a.x() <= q.x()) == (b.x() <= q.x())) continue;
    crossings += a.y() + (q.x() - a.x()) / (b.x() - a.x()) * (b.y() - a.y()) > q.y() ? 1 : 0;
  }
  return crossings % 2 == 1;
}

TEST(ProfileBit, HasTheSizesOfItsOutline) {
  const DrillBit match_head = profile_bit(kMatchHead);
  EXPECT_EQ(match_head.shape, BitShape::profile);
  EXPECT_EQ(match_head.diameter_mm, 3.0);
  EXPECT_EQ(match_head.length_mm, 60.0);
  EXPECT_EQ(match_head.tip_length_mm, 1.5);
  EXPECT_EQ(match_head, profile_bit(kMatchHead));
  // A ball of 2 mm: it meets the shaft of 1.2 mm 0.8 mm behind its centre (6, 8, 10).
  const DrillBit probe = profile_bit({{0.0, 0.0}, {1.8, 0.6, true}, {60.0, 0.6}});
  EXPECT_NEAR(probe.diameter_mm, 2.0, 1e-15);
  EXPECT_NEAR(probe.tip_length_mm, 1.0, 1e-15);
  // A flat end is widest at once.
  EXPECT_EQ(profile_bit({{0.0, 1.0}, {9.0, 1.0}}).tip_length_mm, 0.0);
}

TEST(ProfileBit, IsAsFarAsTheNearestOfManyPlacesOfItsOutlineAndHoldsWhatIsBelow) {
  constexpr std::uint64_t kSeed = 7;
  constexpr double kStepMm = 1e-3;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  Draw draw(kSeed);
  int inside = 0;
  for (int n = 0; n < 60; ++n) {
    const DrillBit bit = n == 0 ? profile_bit(kMatchHead) : test::random_profile(draw);
    const BitProfile profile(bit);
    const std::vector<Vec2> line = polyline(bit.outline, kStepMm);
    for (int k = 0; k < 60; ++k) {
      const Vec2 q(draw(-0.1, 1.1) * bit.length_mm, draw(0.0, 1.6) * bit.radius_mm());
      double nearest_mm = std::numeric_limits<double>::infinity();
      for (const Vec2& place : line) nearest_mm = std::min(nearest_mm, (place - q).squaredNorm());
      nearest_mm = std::sqrt(nearest_mm);
      const double distance_mm = profile.distance_mm(q.x(), q.y());
      // Places of the line lie on the outline, and none of the outline is further from them than half a step.
      ASSERT_LE(std::abs(distance_mm), nearest_mm + 1e-9) << n << ": " << q.transpose();
      ASSERT_GE(std::abs(distance_mm), nearest_mm - 0.5 * kStepMm) << n << ": " << q.transpose();
      // A chord of an arc lies step² / 8 radius within it.
      if (std::abs(distance_mm) < 1e-6) continue;
      ASSERT_EQ(profile.contains(q.x(), q.y() * q.y()), is_below(line, q)) << n << ": " << q.transpose();
      ASSERT_EQ(distance_mm < 0.0, is_below(line, q)) << n << ": " << q.transpose();
      inside += distance_mm < 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(inside, 500);
}

TEST(ProfileBit, IsTheShapeThatItRepeats) {
  constexpr std::uint64_t kSeed = 8;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  Draw draw(kSeed);
  for (int n = 0; n < 2'000; ++n) {
    const DrillBit bit = test::random_bit(draw);
    const BitProfile shape(bit), profile(test::profile_like(bit));
    ASSERT_NEAR(profile.length_mm(), shape.length_mm(), 1e-12);
    ASSERT_NEAR(profile.radius_mm(), shape.radius_mm(), 1e-14);
    ASSERT_EQ(profile.pieces().size(), shape.pieces().size()) << int(bit.shape);
    // A drill's outline, but where it is all tip, is bounded as tightly as a drill.
    if (bit.shape == BitShape::drill && bit.tip_length_mm < bit.length_mm) {
      ASSERT_TRUE(profile.is_cone_and_cylinder());
      ASSERT_EQ(profile.cone_slope(), shape.cone_slope());
      ASSERT_EQ(profile.cone_offset_mm(), shape.cone_offset_mm());
    }
    for (int k = 0; k < 10; ++k) {
      const Vec2 q(draw(-0.2, 1.2) * shape.length_mm(), draw(0.0, 2.0) * shape.radius_mm());
      ASSERT_NEAR(profile.distance_mm(q.x(), q.y()), shape.distance_mm(q.x(), q.y()), 1e-12) << int(bit.shape);
    }
  }
}

TEST(ProfileBit, IsRejectedWithThePlaceAtFault) {
  const auto rejects = [](std::vector<OutlinePoint> outline, const char* what) {
    EXPECT_THAT([&] { profile_bit(outline); }, ThrowsMessage<Error>(HasSubstr(what)));
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  rejects({}, "2 to 17 places, found 0");
  rejects({{0.0, 1.0}}, "2 to 17 places, found 1");
  std::vector<OutlinePoint> many;
  for (int n = 0; n < 18; ++n) many.push_back({1.0 * n, 1.0});
  rejects(many, "2 to 17 places, found 18");
  many.pop_back();
  EXPECT_NO_THROW(profile_bit(many));
  for (const double bad : {nan, infinite, -1.0, 501.0}) rejects({{0.0, 1.0}, {bad, 1.0}}, "place 2");
  for (const double bad : {nan, infinite, -1.0, 101.0, 0.0, 0.009}) rejects({{0.0, 1.0}, {9.0, bad}}, "place 2");
  rejects({{0.5, 1.0}, {9.0, 1.0}}, "place 1 of the outline: expected the tip");
  rejects({{0.0, 1.0, true}, {9.0, 1.0}}, "place 1 of the outline: expected the tip");
  rejects({{0.0, 1.0}, {9.0, 1.0}, {8.0, 1.0}}, "place 3 of the outline: expected it no nearer to the tip");
  rejects({{0.0, 1.0}, {9.0, 1.0}, {9.0, 1.0}}, "another place");
  rejects({{0.0, 0.5}, {4.0, 1.0}, {4.0, 2.0}, {4.0, 1.5}, {9.0, 1.5}}, "no more than two places");
  rejects({{0.0, 1.0}, {4.0, 1.0}, {4.0, 0.5, true}, {9.0, 0.5}}, "an arc to lead further back");
  rejects({{0.0, 1.0}, {4.0, 0.0}, {9.0, 1.0}}, "at least 0.01 mm");
  rejects({{0.0, 1.0}, {9.0, 0.0}}, "at least 0.01 mm");
  rejects({{0.0, 0.0}, {9.0, 0.0}}, "at least 0.01 mm");
  rejects({{0.0, 2.0}, {0.0, 1.0}, {9.0, 1.0}}, "a flat tip to widen");
  rejects({{0.0, 1.0}, {9.0, 1.0}, {9.0, 2.0}}, "a flat base to narrow");
  rejects({{0.0, 1.0}, {1e-4, 1.0}}, "0.001 mm");
  rejects({{0.0, 0.5}, {0.04, 1.5}, {9.0, 1.5}}, "a slope of at most 20");
  rejects({{0.0, 1.0}, {0.001, 50.0, true}}, "an arc of a ball");
  EXPECT_NO_THROW(profile_bit({{0.0, 0.0}, {3.0, 0.0, true}}));  // a ball alone
}

TEST(ProfileBit, HasNoOtherSizesThanItsOutlines) {
  DrillBit bit = profile_bit(kMatchHead);
  bit.diameter_mm = 2.9;
  EXPECT_THAT([&] { check_bit(bit); }, ThrowsMessage<Error>(AllOf(HasSubstr("3 x 60 mm"), HasSubstr("2.9 x 60 mm"))));
  DrillBit drill;
  drill.outline = kMatchHead;
  EXPECT_THAT([&] { check_bit(drill); }, ThrowsMessage<Error>(HasSubstr("outline of profiles only")));
}

TEST(Resized, KeepsTheShapeAndTheLength) {
  const DrillBit wider = resized(profile_bit(kMatchHead), 4.5, 60.0);
  EXPECT_NEAR(wider.diameter_mm, 4.5, 1e-14);
  EXPECT_EQ(wider.length_mm, 60.0);
  for (std::size_t n = 0; n < kMatchHead.size(); ++n) {
    EXPECT_DOUBLE_EQ(wider.outline[n].radius_mm, 1.5 * kMatchHead[n].radius_mm);
    if (n + 1 < kMatchHead.size()) {
      EXPECT_DOUBLE_EQ(wider.outline[n].back_mm, 1.5 * kMatchHead[n].back_mm);
    }
  }
  // A ball has no shaft that could make up the length.
  EXPECT_EQ(resized(profile_bit({{0.0, 0.0}, {3.0, 0.0, true}}), 6.0, 3.0).length_mm, 6.0);
  const DrillBit burr = resized({3.0, 40.0, 1.0, BitShape::conical_burr, 0.5, 1.2}, 6.0, 50.0);
  EXPECT_EQ(burr, (DrillBit{6.0, 50.0, 2.0, BitShape::conical_burr, 1.0, 2.4}));
  for (const test::Tool& tool : test::every_tool()) {
    EXPECT_EQ(resized(tool.bit, tool.bit.diameter_mm, tool.bit.length_mm), tool.bit) << tool.name;
  }
  EXPECT_THROW(resized(profile_bit(kMatchHead), 3.0, 10.0), Error);  // before the neck's end
  EXPECT_THROW(resized(DrillBit{}, 0.0, 50.0), Error);
}

}  // namespace
}  // namespace spinaltap
