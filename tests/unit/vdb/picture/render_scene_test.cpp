// What pictures show beside the bone's own surface: holes, cuts, bits, paths, and what lies behind.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/cut_hole.h"
#include "tests/support/picture_colours.h"
#include "vdb/picture/render.h"

namespace spinaltap {
namespace {

using test::is_white;
using test::kBall;

constexpr int kSceneWidth = 300;
constexpr double kPixelMm = 0.1;

const BoneModel& cancellous_ball() {
  static const BoneModel bone = test::bake_ball(kBall, 0.25, 100);  // cancellous bone, which is red
  return bone;
}

/// The ball from behind, 30 mm across: a place is its x and z. In the picture the patient's left (+x) is on the left.
RenderOptions from_behind() {
  RenderOptions options;
  options.width = kSceneWidth;
  options.height = kSceneWidth;
  options.close_up = CloseUp{kBall.centre_mm, kSceneWidth * kPixelMm};
  return options;
}

/// The colour at so many mm to the patient's left of the ball's middle and above it.
std::array<int, 3> colour_beside(const Image& image, double left_mm, double up_mm) {
  return test::pixel_colour(image, static_cast<int>(std::floor(0.5 * kSceneWidth - left_mm / kPixelMm)),
                            static_cast<int>(std::floor(0.5 * kSceneWidth - up_mm / kPixelMm)));
}

bool is_red(const std::array<int, 3>& colour) { return colour[0] > 1.3 * std::max(1, colour[1]); }
bool is_green(const std::array<int, 3>& colour) { return colour[1] > 1.3 * std::max(colour[0], colour[2]); }
bool is_blue(const std::array<int, 3>& colour) { return colour[2] > colour[0] && colour[2] > colour[1]; }

TEST(RenderScene, ShowsACloseUpToScale) {
  const Image image = render_bone(cancellous_ball(), from_behind());
  for (const double turn : {0.0, 0.9, 2.0, 3.3, 4.6, 5.8}) {
    EXPECT_FALSE(is_white(colour_beside(image, 9.85 * std::cos(turn), 9.85 * std::sin(turn)))) << turn;
    EXPECT_TRUE(is_white(colour_beside(image, 10.15 * std::cos(turn), 10.15 * std::sin(turn)))) << turn;
  }
}

TEST(RenderScene, KeepsAHolesRimSharp) {
  // Towards the front and out of the ball: a hole of 3 mm radius, seen straight on.
  const Vec3 axis = -Vec3::UnitY();
  const BoneModel drilled = test::without_hole(cancellous_ball(), {6.0, 60.0, 1.0}, {kBall.centre_mm, axis},
                                               {kBall.centre_mm + 20.0 * axis, axis});
  const Image through = render_bone(drilled, from_behind());
  for (int n = 0; n < 64; ++n) {
    const double turn = 2.0 * std::numbers::pi * n / 64;
    // A pixel is 0.1 mm, 0.4 voxels.
    EXPECT_TRUE(is_white(colour_beside(through, 2.88 * std::cos(turn), 2.88 * std::sin(turn)))) << n;
    const auto beside = colour_beside(through, 3.12 * std::cos(turn), 3.12 * std::sin(turn));
    EXPECT_FALSE(is_white(beside)) << n;
    EXPECT_FALSE(is_red(beside)) << n;
  }
}

TEST(RenderScene, CutsTheBoneOpen) {
  RenderOptions options = from_behind();
  // 2 mm before the middle, as seen: a disc of sqrt(96) mm, red, and nothing of the surface.
  options.cut = CutPlane{kBall.centre_mm + 2.0 * Vec3::UnitY(), 3.0 * Vec3::UnitY()};
  const Image image = render_bone(cancellous_ball(), options);
  const double disc_mm = std::sqrt(96.0);
  for (int n = 0; n < 64; ++n) {
    const double turn = 2.0 * std::numbers::pi * n / 64;
    EXPECT_TRUE(is_red(colour_beside(image, (disc_mm - 0.15) * std::cos(turn), (disc_mm - 0.15) * std::sin(turn))))
        << n;
    EXPECT_FALSE(is_red(colour_beside(image, (disc_mm + 0.15) * std::cos(turn), (disc_mm + 0.15) * std::sin(turn))))
        << n;
  }
  // The half nearer to the eye is kept: its surface is as before.
  options.cut->normal = -options.cut->normal;
  const Image near_half = render_bone(cancellous_ball(), options);
  const Image whole = render_bone(cancellous_ball(), from_behind());
  EXPECT_EQ(colour_beside(near_half, 1.0, 2.0), colour_beside(whole, 1.0, 2.0));
  EXPECT_TRUE(is_white(colour_beside(near_half, 9.9, 0.0)));
  // Along the eye's direction.
  options.cut->normal = Vec3::UnitX();
  const Image left_half_gone = render_bone(cancellous_ball(), options);
  EXPECT_TRUE(is_white(colour_beside(left_half_gone, 1.0, 0.0)));
  EXPECT_EQ(colour_beside(left_half_gone, -5.0, 1.0), colour_beside(whole, -5.0, 1.0));
}

TEST(RenderScene, ShowsBitsAndPathsOutsideTheBoneAndWithinItOnlyThroughIt) {
  RenderOptions options = from_behind();
  const Pose across{kBall.centre_mm + Vec3(-13.0, 0.0, 4.0), -Vec3::UnitX()};
  options.bit = RenderedBit{{3.0, 27.0, 2.0}, across};
  options.paths = {{"p", kBall.centre_mm + Vec3(13.0, 0.0, -4.0), kBall.centre_mm + Vec3(-13.0, 0.0, -4.0), {}}};
  const Image opaque = render_bone(cancellous_ball(), options);
  EXPECT_TRUE(is_blue(colour_beside(opaque, 12.0, 4.0)));
  EXPECT_TRUE(is_green(colour_beside(opaque, 12.0, -4.0)));
  EXPECT_TRUE(is_white(colour_beside(opaque, 12.0, 6.0))) << "1.5 mm from its axis";
  EXPECT_FALSE(is_blue(colour_beside(opaque, 0.0, 4.0)));
  EXPECT_FALSE(is_green(colour_beside(opaque, 0.0, -4.0)));
  options.opacity = 0.2;
  const Image thin = render_bone(cancellous_ball(), options);
  EXPECT_TRUE(is_green(colour_beside(thin, 0.0, -4.0)));
  options.opacity = 0.0;
  const Image gone = render_bone(cancellous_ball(), options);
  EXPECT_TRUE(is_white(colour_beside(gone, 0.0, 0.0)));
  EXPECT_EQ(colour_beside(gone, 12.0, 4.0), colour_beside(opaque, 12.0, 4.0));
}

TEST(RenderScene, ShowsHolesThroughTheBone) {
  const Pose start{kBall.centre_mm + Vec3(20.0, 0.0, 0.0), -Vec3::UnitX()};
  const Pose end{kBall.centre_mm, -Vec3::UnitX()};
  const BoneModel drilled = test::without_hole(cancellous_ball(), {4.0, 30.0, 1.0}, start, end);
  RenderOptions options = from_behind();
  EXPECT_FALSE(is_red(colour_beside(render_bone(drilled, options), 5.0, 0.0)));
  options.opacity = 0.2;
  const Image thin = render_bone(drilled, options);
  EXPECT_TRUE(is_red(colour_beside(thin, 5.0, 0.0)));
  EXPECT_FALSE(is_red(colour_beside(thin, -5.0, 0.0)));
  EXPECT_FALSE(is_red(colour_beside(thin, 5.0, 3.0)));
}

TEST(RenderScene, RejectsWhatCannotBeShown) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  RenderOptions bad = from_behind();
  bad.close_up->width_mm = 0.0;
  EXPECT_THROW(render_bone(cancellous_ball(), bad), Error);
  bad = from_behind();
  bad.opacity = 1.1;
  EXPECT_THROW(render_bone(cancellous_ball(), bad), Error);
  bad.opacity = kNone;
  EXPECT_THROW(render_bone(cancellous_ball(), bad), Error);
  bad = from_behind();
  bad.cut = CutPlane{kBall.centre_mm, Vec3::Zero()};
  EXPECT_THROW(render_bone(cancellous_ball(), bad), Error);
  bad = from_behind();
  bad.bit = RenderedBit{{0.0, 10.0, 1.0}, {}};
  EXPECT_THROW(render_bone(cancellous_ball(), bad), Error);
  bad = from_behind();
  bad.paths = {{"p", kBall.centre_mm, kBall.centre_mm, {}}};
  EXPECT_THROW(render_bone(cancellous_ball(), bad), Error);
}

}  // namespace
}  // namespace spinaltap
