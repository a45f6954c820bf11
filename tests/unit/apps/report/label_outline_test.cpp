#include "apps/report/label_outline.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace spinaltap {
namespace {

constexpr Colour kRed{200, 0, 0};

struct OutlineScene {
  LabelPixels pixels{64, 64, std::vector<int>(64 * 64, 0)};
  Image image{64, 64, std::vector<std::uint8_t>(64 * 64 * 3, 10)};

  void fill(int left, int top, int right, int bottom, int label) {
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) pixels.labels[static_cast<std::size_t>(y * 64 + x)] = label;
    }
  }
  bool red(int x, int y) const { return image.rgb[3 * static_cast<std::size_t>(y * 64 + x)] == kRed[0]; }
  int count() const {
    int red_pixels = 0;
    for (int n = 0; n < 64 * 64; ++n) red_pixels += red(n % 64, n / 64) ? 1 : 0;
    return red_pixels;
  }
};

TEST(LabelOutline, ColoursTheRimWithinTheLabelOnly) {
  OutlineScene scene;
  scene.fill(10, 12, 30, 44, 5);
  scene.fill(30, 12, 40, 44, 6);  // touches it
  draw_label_outline(scene.image, scene.pixels, 5, kRed, false);
  EXPECT_EQ(scene.count(), 2 * (20 + 32) - 4);
  EXPECT_TRUE(scene.red(10, 12));
  EXPECT_TRUE(scene.red(29, 20));
  EXPECT_FALSE(scene.red(30, 20));  // the neighbour's
  EXPECT_FALSE(scene.red(11, 13));
}

TEST(LabelOutline, GoesAroundHolesAndSeveralParts) {
  OutlineScene scene;
  scene.fill(10, 10, 30, 30, 5);
  scene.fill(18, 18, 22, 22, 0);
  scene.fill(40, 40, 43, 43, 5);
  draw_label_outline(scene.image, scene.pixels, 5, kRed, false);
  // 76 without, 16 pixels share an edge with the hole, 8 of the small part.
  EXPECT_EQ(scene.count(), 76 + 16 + 8);
}

TEST(LabelOutline, IsNotDrawnWhereThePictureEnds) {
  OutlineScene scene;
  scene.fill(0, 0, 20, 64, 5);
  draw_label_outline(scene.image, scene.pixels, 5, kRed, false);
  EXPECT_EQ(scene.count(), 64);
  EXPECT_TRUE(scene.red(19, 30));
  EXPECT_FALSE(scene.red(5, 0));
}

TEST(LabelOutline, DashesAnyDirectionAlike) {
  OutlineScene square;
  square.fill(4, 4, 60, 60, 5);
  draw_label_outline(square.image, square.pixels, 5, kRed, true);
  // 9 of 16 edges along sides of 56 pixels: 126 of 224, and pixels of corners that have a drawn and an undrawn edge.
  EXPECT_NEAR(square.count(), 126, 6);
  OutlineScene diamond;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      if (std::abs(x - 32) + std::abs(y - 32) <= 28) diamond.pixels.labels[static_cast<std::size_t>(y * 64 + x)] = 5;
    }
  }
  draw_label_outline(diamond.image, diamond.pixels, 5, kRed, true);
  // Each of its four sides is neither solid nor bare: 28 pixels, of which 9 to 16 edges a period of 8 pixels are drawn.
  for (const auto& [sx, sy] : {std::pair{1, 1}, std::pair{1, -1}, std::pair{-1, 1}, std::pair{-1, -1}}) {
    int drawn = 0;
    for (int n = 1; n < 28; ++n) drawn += diamond.red(32 + sx * n, 32 + sy * (28 - n)) ? 1 : 0;
    EXPECT_GE(drawn, 10) << sx << sy;
    EXPECT_LE(drawn, 21) << sx << sy;
  }
}

}  // namespace
}  // namespace spinaltap
