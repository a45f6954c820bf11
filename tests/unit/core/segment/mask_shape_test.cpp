#include "core/segment/mask_shape.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "core/base/error.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// Of 60 x 60 x 40 voxels of 1 mm those that `is_inside` says, asked from their middle on.
BoneMask mask_where(const std::function<bool(const Vec3&)>& is_inside, const Vec3& spacing_mm = Vec3::Ones()) {
  BoneMask mask;
  mask.geometry.size = {60, 60, 40};
  mask.geometry.spacing_mm = spacing_mm;
  mask.inside.assign(mask.geometry.voxel_count(), 0);
  for (int k = 0; k < 40; ++k) {
    for (int j = 0; j < 60; ++j) {
      for (int i = 0; i < 60; ++i) {
        if (is_inside(Vec3(i - 30, j - 30, k - 20))) mask.inside[mask.geometry.offset(i, j, k)] = 1;
      }
    }
  }
  return mask;
}
MaskShape shape_where(const std::function<bool(const Vec3&)>& is_inside) {
  const BoneMask mask = mask_where(is_inside);
  return measure_shape(mask);
}
bool in_ring(const Vec3& p, double middle_x) {
  return std::hypot(std::hypot(p.x() - middle_x, p.y()) - 12.0, p.z()) < 4.5;
}
std::vector<std::string> texts(const std::vector<LevelWarning>& warnings) {
  std::vector<std::string> texts;
  for (const LevelWarning& one : warnings) texts.push_back(one.text);
  return texts;
}

TEST(MaskShape, CountsHandlesPiecesAndHollows) {
  const MaskShape ball = shape_where([](const Vec3& p) { return p.norm() < 15.0; });
  EXPECT_EQ(ball.pieces, 1U);
  EXPECT_EQ(ball.handles, 0);
  EXPECT_EQ(ball.hollow_share, 0.0);
  EXPECT_NEAR(ball.depth_mm, 15.0, 0.6);

  const MaskShape ring = shape_where([](const Vec3& p) { return in_ring(p, 0.0); });
  EXPECT_EQ(ring.handles, 1);
  EXPECT_EQ(ring.pieces, 1U);
  EXPECT_EQ(shape_where([](const Vec3& p) { return in_ring(p, -12.0) || in_ring(p, 12.0); }).handles, 2)
      << "two rings that meet";

  const MaskShape shell = shape_where([](const Vec3& p) { return p.norm() < 15.0 && p.norm() > 10.0; });
  EXPECT_EQ(shell.handles, 0);
  EXPECT_NEAR(shell.hollow_share, 1000.0 / (15.0 * 15.0 * 15.0 - 1000.0), 0.03);

  const MaskShape two = shape_where([](const Vec3& p) { return (p - Vec3(15, 0, 0)).norm() < 10.0 || p.x() < -27; });
  EXPECT_EQ(two.pieces, 2U);
  EXPECT_EQ(two.handles, 0);
  const MaskShape corners = shape_where([](const Vec3& p) { return (p.x() < 0) == (p.y() < 0) && p.z() < 0; });
  EXPECT_EQ(corners.pieces, 1U) << "that meet along an edge";
}

TEST(MaskShape, MeasuresDepthInMillimetresAndAtTheGridsBorder) {
  const BoneMask block = mask_where([](const Vec3&) { return true; }, Vec3(1.0, 1.0, 0.5));
  EXPECT_NEAR(measure_shape(block).depth_mm, 10.0, 1e-6);
}

TEST(MaskShape, OfNothingIsNothingAndOfAnotherSizeAnError) {
  const BoneMask empty = mask_where([](const Vec3&) { return false; });
  EXPECT_EQ(measure_shape(empty).pieces, 0U);
  EXPECT_THAT(check_shape({}, true), IsEmpty());
  EXPECT_THROW(measure_shape({empty.geometry, std::vector<std::uint8_t>(7, 1)}), Error);
}

TEST(CheckShape, SaysNothingOfABodyWithARing) {
  const MaskShape shape =
      shape_where([](const Vec3& p) { return in_ring(p, 0.0) || (p - Vec3(0, -14, 0)).norm() < 9; });
  EXPECT_THAT(check_shape(shape, true), IsEmpty());
}

TEST(CheckShape, SaysWhatNoBoneHas) {
  const auto sieve = [](const Vec3& p) {
    const auto near_hole = [](double x) { return std::abs(x - 8.0 * std::round(x / 8.0)) < 1.5; };
    return std::abs(p.z()) < 6.0 && std::max(std::abs(p.x()), std::abs(p.y())) < 20.5 &&
           !(near_hole(p.x()) && near_hole(p.y()));
  };
  const MaskShape holes = shape_where(sieve);
  EXPECT_EQ(holes.handles, 25);
  const std::vector<LevelWarning> of_holes = check_shape(holes, true);
  ASSERT_EQ(of_holes.size(), 1U);
  EXPECT_THAT(of_holes[0].text, HasSubstr("25 holes go through it, expected one"));
  EXPECT_GE(of_holes[0].severity, kSuspect);

  const auto thin = [](const Vec3& p) { return in_ring(p, 0.0) && std::abs(p.z()) < 2.5; };
  EXPECT_THAT(texts(check_shape(shape_where(thin), true)), testing::ElementsAre(HasSubstr("nowhere is it deeper")));
  const auto shell = [](const Vec3& p) { return p.norm() < 15.0 && p.norm() > 4.0; };
  const std::vector<LevelWarning> of_ball = check_shape(shape_where([](const Vec3& p) { return p.norm() < 9; }), true);
  EXPECT_THAT(texts(of_ball), testing::ElementsAre(HasSubstr("no ring of bone closes")));
  EXPECT_LT(of_ball[0].severity, kSuspect) << "a part of the arch may be gone by surgery";
  EXPECT_THAT(check_shape(shape_where([](const Vec3& p) { return p.norm() < 9; }), false), IsEmpty());
  EXPECT_THAT(check_shape(shape_where(shell), false), IsEmpty()) << "a hollow of 2 % is a vessel's";
  const auto hollow = [](const Vec3& p) { return p.norm() < 18.0 && p.norm() > 9.0; };
  EXPECT_THAT(texts(check_shape(shape_where(hollow), false)),
              testing::ElementsAre(HasSubstr("it encloses hollows of 1")));
  const auto two = [](const Vec3& p) { return (p - Vec3(15, 0, 0)).norm() < 9.5 || (p + Vec3(12, 0, 0)).norm() < 7; };
  EXPECT_THAT(texts(check_shape(shape_where(two), false)), testing::ElementsAre(HasSubstr("it is in 2 pieces")));
}

}  // namespace
}  // namespace spinaltap
