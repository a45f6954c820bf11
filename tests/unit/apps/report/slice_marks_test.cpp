#include "apps/report/slice_marks.h"

#include <gtest/gtest.h>

#include <vector>

namespace spinaltap {
namespace {

Image grey_image(int width, int height) {
  return {width, height, std::vector<std::uint8_t>(3 * static_cast<std::size_t>(width * height), 90)};
}

bool is(const Image& image, int x, int y, const Colour& colour) {
  const std::size_t at = 3 * static_cast<std::size_t>(y * image.width + x);
  return image.rgb[at] == colour[0] && image.rgb[at + 1] == colour[1] && image.rgb[at + 2] == colour[2];
}

TEST(SliceMarks, SetsTheLettersOfTheSidesThatTheEdgesShow) {
  // An axial slice as radiologists look at it: right of the patient on the left, anterior on top.
  Image image = grey_image(100, 80);
  draw_side_letters(image, {0, 0, 100, 80}, Vec3::UnitX(), Vec3::UnitY(), 1, kWhite);
  Image expected = grey_image(100, 80);
  draw_text(expected, 4, 36 + 1, "R", 1, kWhite);  // rows 4 + (80 - 7 - 8) / 2, rounded up
  draw_text(expected, 100 - 4 - 5, 36 + 1, "L", 1, kWhite);
  draw_text(expected, 4 + 44, 4, "A", 1, kWhite);  // columns 4 + (100 - 5 - 8) / 2, rounded up
  draw_text(expected, 4 + 44, 80 - 4 - 7, "P", 1, kWhite);
  EXPECT_EQ(image.rgb, expected.rgb);
}

TEST(SliceMarks, DrawsABarOfARoundLength) {
  EXPECT_EQ(round_bar_mm(80.0), 20.0);
  EXPECT_EQ(round_bar_mm(79.0), 10.0);
  EXPECT_EQ(round_bar_mm(200.0), 50.0);
  EXPECT_EQ(round_bar_mm(399.0), 50.0);
  EXPECT_EQ(round_bar_mm(2.0), 0.5);
  Image image = grey_image(300, 100);
  draw_scale_bar(image, {0, 0, 300, 100}, 0.3);  // 90 mm: a bar of 20 mm is 66.7 pixels
  int white = 0;
  for (int x = 0; x < 300; ++x) white += is(image, x, 100 - 6 - 2, kWhite) ? 1 : 0;
  EXPECT_EQ(white, 67);
}

TEST(SliceMarks, CrossLeavesWhatItMarksInSight) {
  Image image = grey_image(60, 60);
  draw_cross(image, 30, 20);
  EXPECT_TRUE(is(image, 30, 20, {90, 90, 90}));
  for (const auto& [x, y] : {std::pair{35, 20}, std::pair{25, 20}, std::pair{30, 15}, std::pair{30, 25}}) {
    EXPECT_TRUE(is(image, x, y, kWhite)) << x << " " << y;
  }
  EXPECT_TRUE(is(image, 35, 21, {0, 0, 0}));
  const Image before = image;
  draw_cross(image, -1, 20);
  draw_cross(image, 30, 60);
  EXPECT_EQ(image.rgb, before.rgb);
}

}  // namespace
}  // namespace spinaltap
