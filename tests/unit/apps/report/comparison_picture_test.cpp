#include "apps/report/comparison_picture.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/support/analytic_bodies.h"

namespace spinaltap {
namespace {

/// How many pixels of a part of a picture are neither its ground nor the white behind a bone.
int drawn_pixels(const Image& image, int left, int right, int top, int bottom) {
  int drawn = 0;
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      const std::uint8_t* pixel = image.rgb.data() + 3 * (static_cast<std::ptrdiff_t>(y) * image.width + x);
      const bool ground = pixel[0] == 24 && pixel[1] == 24 && pixel[2] == 24;
      const bool white = pixel[0] == 255 && pixel[1] == 255 && pixel[2] == 255;
      drawn += ground || white ? 0 : 1;
    }
  }
  return drawn;
}

TEST(ComparisonPicture, HasATileForEachSurfaceAndTheGroundTruth) {
  const BoneModel ball = test::bake_ball({Vec3(0.0, 0.0, 0.0), 6.0}, 0.5);
  Comparison comparison{ball, {}, {}};
  for (const PointMethod method : {PointMethod::pixels, PointMethod::contours}) {
    comparison.surfaces.push_back({method, 0.0, 100, {}, ball});
    comparison.surfaces.push_back({method, 0.5, 100, {}, std::nullopt});
  }
  const Image picture = comparison_picture(comparison);
  // Two columns, three rows: two methods and the ground truth.
  const int column = picture.width / 2;
  const int row = picture.height / 3;
  EXPECT_GT(column, row);
  const auto in_tile = [&](int x, int y) {
    return drawn_pixels(picture, x * column, (x + 1) * column, y * row, (y + 1) * row);
  };
  // A ball fills about three quarters of a tile's height.
  for (int y = 0; y < 3; ++y) EXPECT_GT(in_tile(0, y), row * row / 4) << y;
  // Where there is no surface, and beside the ground truth, there are words at most.
  for (int y = 0; y < 3; ++y) EXPECT_LT(in_tile(1, y), row * row / 10) << y;
}

TEST(ComparisonPicture, NeedsSomethingToCompare) {
  const Comparison nothing{test::bake_ball({Vec3(0.0, 0.0, 0.0), 3.0}, 0.5), {}, {}};
  EXPECT_THROW(comparison_picture(nothing), Error);
}

}  // namespace
}  // namespace spinaltap
