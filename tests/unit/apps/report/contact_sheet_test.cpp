#include "apps/report/contact_sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/report/slice_marks.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

using testing::ElementsAre;

/// Each slice of one HU: white (1400 and above) where k is even, black (-400) where it is odd.
CtVolume striped(int columns, int rows, int slices) {
  GridGeometry geometry;
  geometry.size = {columns, rows, slices};
  std::vector<std::int16_t> hu(geometry.voxel_count());
  for (std::size_t n = 0; n < hu.size(); ++n) {
    const std::size_t k = n / (static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    hu[n] = k % 2 == 0 ? 1500 : -1000;
  }
  return make_ct_volume(geometry, std::move(hu));
}

int grey_at(const Image& image, int x, int y) {
  return image
      .rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x))];
}

TEST(ContactSheet, ChoosesSlicesEvenlyFromFirstToLast) {
  EXPECT_THAT(contact_sheet_slices(3, 20), ElementsAre(0, 1, 2));
  EXPECT_THAT(contact_sheet_slices(101, 5), ElementsAre(0, 25, 50, 75, 100));
  EXPECT_THAT(contact_sheet_slices(9, 1), ElementsAre(4));
}

TEST(ContactSheet, ShowsEachSliceInItsPlace) {
  const Image sheet = contact_sheet(striped(64, 64, 4), {.columns = 2});
  EXPECT_EQ(sheet.width, 2 * (256 + 6) + 6);
  EXPECT_EQ(sheet.height, 2 * (256 + 22 + 6) + 6);
  // A quarter into each picture, away from letters: k 0 and 1 above, 2 and 3 below.
  EXPECT_EQ(grey_at(sheet, 6 + 64, 28 + 64), 255);
  EXPECT_EQ(grey_at(sheet, 6 + 262 + 64, 28 + 64), 0);
  EXPECT_EQ(grey_at(sheet, 6 + 64, 28 + 284 + 64), 255);
  EXPECT_EQ(grey_at(sheet, 6 + 262 + 64, 28 + 284 + 64), 0);
}

TEST(ContactSheet, StaysBoundedForAnyShapeOfCt) {
  for (const auto& [columns, rows, slices] :
       {std::array{1000, 3, 40}, std::array{3, 1000, 40}, std::array{2, 2, 300}}) {
    const Image sheet = contact_sheet(striped(columns, rows, slices));
    EXPECT_LE(sheet.width, 1400);
    EXPECT_LE(sheet.height, 1400);
    EXPECT_EQ(sheet.rgb.size(), 3u * static_cast<unsigned>(sheet.width) * static_cast<unsigned>(sheet.height));
  }
}

TEST(ContactSheet, AveragesVoxelsThatShareAPixel) {
  GridGeometry geometry;
  geometry.size = {1024, 1024, 2};
  std::vector<std::int16_t> hu(geometry.voxel_count());
  for (std::size_t n = 0; n < hu.size(); ++n) hu[n] = (n + n / 1024) % 2 == 0 ? 1400 : -400;  // a chequerboard
  const Image sheet = contact_sheet(make_ct_volume(geometry, std::move(hu)));
  EXPECT_NEAR(grey_at(sheet, 6 + 64, 28 + 64), 128, 2);
}

TEST(ContactSheet, RejectsOptionsOutOfRange) {
  EXPECT_THROW(contact_sheet(striped(8, 8, 2), {.max_slices = 0}), Error);
  EXPECT_THROW(contact_sheet(striped(8, 8, 2), {.tile_pixels = 100000}), Error);
}

TEST(PixelText, DrawsDotsInTheColourAndCutsAtTheBorder) {
  Image image{12, 9, std::vector<std::uint8_t>(12 * 9 * 3, 50)};
  draw_text(image, 1, 1, "I", 1, {200, 100, 0});
  EXPECT_EQ(grey_at(image, 3, 1), 200);  // the middle of the upper bar
  EXPECT_EQ(grey_at(image, 3, 4), 200);  // the stem
  EXPECT_EQ(grey_at(image, 2, 4), 0);    // its rim
  EXPECT_EQ(grey_at(image, 9, 4), 50);
  draw_text(image, -3, 7, "888888", 3, {200, 100, 0});
  EXPECT_EQ(image.rgb.size(), 12u * 9u * 3u);
  EXPECT_EQ(pixel_text_width("AB", 2), 22);
}

}  // namespace
}  // namespace spinaltap
