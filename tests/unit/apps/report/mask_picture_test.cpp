#include "apps/report/mask_picture.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/error.h"

namespace spinaltap {
namespace {

/// 40 mm of soft tissue with a mask of 10 x 16 x 6 mm in its middle.
struct Scene {
  CtVolume ct;
  BoneMask mask;

  Scene() {
    GridGeometry geometry;
    geometry.size = {40, 40, 40};
    ct = make_ct_volume(geometry, std::vector<std::int16_t>(geometry.voxel_count(), 500));
    mask = {geometry, std::vector<std::uint8_t>(geometry.voxel_count(), 0)};
    for (int k = 17; k < 23; ++k) {
      for (int j = 12; j < 28; ++j) {
        for (int i = 15; i < 25; ++i) mask.inside[geometry.offset(i, j, k)] = 1;
      }
    }
  }
};

TEST(MaskPicture, DrawsTheOutlineInAllThreeSlices) {
  const Scene scene;
  const Image picture = mask_picture(scene.ct, scene.mask, Vec3::Constant(20.0), {.margin_mm = 5.0, .pixel_mm = 0.5});
  std::size_t coloured = 0;
  for (std::size_t p = 0; p < picture.rgb.size(); p += 3) coloured += picture.rgb[p] != picture.rgb[p + 2] ? 1U : 0U;
  // Rims of rectangles of 20 x 32 (axial), 32 x 12 (sagittal) and 20 x 12 pixels (coronal): 2 (a + b) - 4 each.
  EXPECT_EQ(coloured, 100U + 84U + 60U);
}

TEST(MaskPicture, RefusesAnEmptyMaskAndAnotherGrid) {
  Scene scene;
  BoneMask other = scene.mask;
  other.geometry.size = {40, 40, 39};
  EXPECT_THROW(mask_picture(scene.ct, other, Vec3::Constant(20.0)), Error);
  std::fill(scene.mask.inside.begin(), scene.mask.inside.end(), std::uint8_t{0});
  EXPECT_THROW(mask_picture(scene.ct, scene.mask, Vec3::Constant(20.0)), Error);
}

}  // namespace
}  // namespace spinaltap
