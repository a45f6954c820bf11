// Compiled with optimisation: long loops of its own.

#include "vdb/picture/render.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/cut_hole.h"
#include "tests/support/picture_colours.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

using test::Ball;
using test::kBall;

const BoneModel& shown_ball() {
  static const BoneModel bone = test::bake_ball(kBall, 0.25, 100);
  return bone;
}

RenderOptions options() {
  RenderOptions result;
  result.width = 320;
  result.height = 240;
  return result;
}

/// Where a picture is not white, pixels.
struct Disc {
  double radius = 0.0;  ///< of a disc of the same area
  double x = 0.0;       ///< of the centre
  double y = 0.0;
  int left = 0, right = -1, top = 0, bottom = -1;

  explicit Disc(const Image& image) : left(image.width), top(image.height) {
    double count = 0.0;
    for (int row = 0; row < image.height; ++row) {
      for (int column = 0; column < image.width; ++column) {
        if (test::is_white(test::pixel_colour(image, column, row))) continue;
        ++count;
        x += column + 0.5;
        y += row + 0.5;
        left = std::min(left, column);
        right = std::max(right, column);
        top = std::min(top, row);
        bottom = std::max(bottom, row);
      }
    }
    x /= count;
    y /= count;
    radius = std::sqrt(count / std::numbers::pi);
  }
};

TEST(RenderBone, DrawsASphereAsADiscThatFillsThePicture) {
  const Image image = render_bone(shown_ball(), options());
  ASSERT_EQ(image.rgb.size(), std::size_t{320 * 240 * 3});
  const Disc disc(image);
  // The picture's lower side, 240 pixels, less a margin. The frame is known to a leaf of 8 voxels, 2 of the ball's 20
  // mm.
  EXPECT_LT(2.0 * disc.radius, 240.0);
  EXPECT_GT(2.0 * disc.radius, 0.8 * 240.0);
  EXPECT_NEAR(disc.x, 160.0, 0.05 * 240.0);
  EXPECT_NEAR(disc.y, 120.0, 0.05 * 240.0);
  // A pixel at the rim counts when a ray of four meets bone: up to a pixel more on each side.
  EXPECT_NEAR(disc.right - disc.left + 1, 2.0 * disc.radius, 2.0);
  EXPECT_NEAR(disc.bottom - disc.top + 1, 2.0 * disc.radius, 2.0);
  EXPECT_NEAR(0.5 * (disc.left + disc.right + 1), disc.x, 0.5);
  EXPECT_NEAR(0.5 * (disc.top + disc.bottom + 1), disc.y, 0.5);
  EXPECT_GT(disc.top, 0);
  EXPECT_LT(disc.bottom, 239);
  for (const auto& [x, y] : {std::pair{0, 0}, {319, 0}, {0, 239}, {319, 239}}) {
    EXPECT_TRUE(test::is_white(test::pixel_colour(image, x, y)));
  }
}

TEST(RenderBone, LightsFromAbove) {
  const Image whole = render_bone(shown_ball(), options());
  EXPECT_GT(test::pixel_colour(whole, 160, 60)[0], test::pixel_colour(whole, 160, 190)[0]);
}

TEST(RenderBone, IsTheSameAtOneAndTwoThreads) {
  const Image many = render_bone(shown_ball(), options());
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(render_bone(shown_ball(), options()).rgb, many.rgb);
}

SLOW_TESTS("RenderDrilled.IsTheSameAsWhenAllIsTracedAgain");

TEST(RenderDrilled, IsTheSameAsWhenAllIsTracedAgain) {
  const Pose start{kBall.centre_mm + 14.0 * Vec3::UnitY(), -Vec3::UnitY()};
  const Pose end{kBall.centre_mm, -Vec3::UnitY()};
  const BoneModel drilled = test::without_hole(shown_ball(), {3.0, 30.0, 1.0}, start, end);
  for (const Vec3& from : {Vec3(0.0, 1.0, 0.0), Vec3(0.7, 0.6, 0.3), Vec3(0.0, -1.0, 0.0)}) {
    for (const double opacity : {1.0, 0.4}) {
      RenderOptions how = options();
      how.from = from;
      how.opacity = opacity;
      const Image before = render_bone(shown_ball(), how);
      const Image whole = render_bone(drilled, how);
      EXPECT_EQ(render_drilled(drilled, before, how).rgb, whole.rgb) << from.transpose() << ", " << opacity;
      EXPECT_EQ(render_drilled(shown_ball(), before, how).rgb, before.rgb);
      if (opacity < 1.0) {
        EXPECT_NE(whole.rgb, before.rgb);
      }
    }
  }
  EXPECT_THROW(render_drilled(drilled, {3, 3, std::vector<std::uint8_t>(27)}, options()), Error);
}

TEST(RenderBone, ColoursWhatWasDrilledByItsCtNumber) {
  // Straight into the middle of the picture, 100 HU: cancellous bone, which is red.
  const Pose start{kBall.centre_mm + 14.0 * Vec3::UnitY(), -Vec3::UnitY()};
  const Pose end{kBall.centre_mm, -Vec3::UnitY()};
  const BoneModel drilled = test::without_hole(shown_ball(), {6.0, 30.0, 1.0}, start, end);
  const Image image = render_bone(drilled, options());
  const auto redness = [&](int x, int y) {
    const auto colour = test::pixel_colour(image, x, y);
    return static_cast<double>(colour[0]) / std::max(1, colour[1]);
  };
  EXPECT_GT(redness(150, 125), 1.3);
  EXPECT_LT(redness(100, 120), 1.15);
}

TEST(RenderBone, RejectsSizesAndViewsWithoutSense) {
  RenderOptions bad = options();
  bad.width = 0;
  EXPECT_THROW(render_bone(shown_ball(), bad), Error);
  bad = options();
  bad.height = 100000;
  EXPECT_THROW(render_bone(shown_ball(), bad), Error);
  bad = options();
  bad.up = bad.from;
  EXPECT_THROW(render_bone(shown_ball(), bad), Error);
  bad = options();
  bad.from = Vec3::Constant(std::nan(""));
  EXPECT_THROW(render_bone(shown_ball(), bad), Error);
}

}  // namespace
}  // namespace spinaltap
