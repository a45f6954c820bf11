#include "core/segment/detail/grey_closing.h"

#include <gtest/gtest.h>

namespace spinaltap {
namespace {

/// A slab of 800 with a dark sheet of `width` voxels across it, and dark ends.
FloatGrid gap_of(int width) {
  FloatGrid grid;
  grid.geometry.size = {24, 9, 9};
  grid.geometry.spacing_mm = Vec3(0.8, 0.8, 0.8);
  for (int n = 0; n < 24 * 9 * 9; ++n) {
    const int i = n % 24;
    const bool dark = i < 5 || i >= 19 || (i >= 10 && i < 10 + width);
    grid.values.push_back(dark ? 100.0F : 800.0F);
  }
  return grid;
}

TEST(GreyClosing, ClosesAGapNarrowerThanTheBoxAndKeepsAWiderOne) {
  // The box reaches 1.6 mm, two voxels, to either side: it closes gaps of up to four voxels.
  for (const int width : {1, 3, 4}) {
    const FloatGrid grid = gap_of(width);
    EXPECT_EQ(close_gaps(grid, 1.6).closed[grid.geometry.offset(10, 4, 4)], 800.0F) << width;
  }
  const FloatGrid wide = gap_of(7);
  EXPECT_EQ(close_gaps(wide, 1.6).closed[wide.geometry.offset(13, 4, 4)], 100.0F);
}

TEST(GreyClosing, LeavesTheSlabsEndsWhereTheyAre) {
  const FloatGrid grid = gap_of(0);
  const GreyClosing closing = close_gaps(grid, 1.6);
  EXPECT_EQ(closing.closed, grid.values);
  EXPECT_EQ(closing.peak[grid.geometry.offset(3, 4, 4)], 800.0F);  // within two voxels of the slab
}

}  // namespace
}  // namespace spinaltap
