#include "core/ct/crop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/error_of.h"

namespace spinaltap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

CtVolume numbered_ct(const Mat3& directions = Mat3::Identity()) {
  GridGeometry geometry;
  geometry.size = {12, 10, 8};
  geometry.spacing_mm = Vec3(0.5, 1.0, 2.0);
  geometry.origin_mm = Vec3(-20.0, 30.0, 5.0);
  geometry.directions = directions;
  std::vector<std::int16_t> hu(geometry.voxel_count());
  for (std::size_t n = 0; n < hu.size(); ++n) hu[n] = static_cast<std::int16_t>(n);
  return make_ct_volume(geometry, std::move(hu));
}

TEST(Crop, KeepsTheVoxelsWhoseCentresLieInTheBox) {
  const CtVolume ct = numbered_ct();
  const CtVolume cropped = crop(ct, block_in_box(ct.geometry, Box3(Vec3(-19.5, 31.1, 0.0), Vec3(-18.0, 34.0, 9.0))));
  EXPECT_THAT(cropped.geometry.size, ElementsAre(4, 3, 3));
  EXPECT_EQ(cropped.geometry.origin_mm, Vec3(-19.5, 32.0, 5.0));
  EXPECT_NE(cropped.source_hash, ct.source_hash);
  EXPECT_EQ(cropped.whole_hash, ct.whole_hash);  // of the same CT: what was planned in the one fits the other
  EXPECT_EQ(
      crop(cropped, block_in_box(cropped.geometry, Box3(Vec3(-19.5, 32.0, 0.0), Vec3(-19.0, 33.0, 9.0)))).whole_hash,
      ct.whole_hash);
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 4; ++i) EXPECT_EQ(cropped.at(i, j, k), ct.at(i + 1, j + 2, k));
    }
  }
}

TEST(Crop, HoldsTheWholeBoxOnAnObliqueGrid) {
  const CtVolume ct = numbered_ct(Eigen::AngleAxisd(0.5, Vec3::UnitZ()).toRotationMatrix());
  const Vec3 middle = ct.geometry.to_patient(Vec3(6, 5, 4));
  const Box3 box(middle - Vec3(1, 1, 2), middle + Vec3(1, 1, 2));
  const VoxelBlock block = block_in_box(ct.geometry, box);
  for (int k = 0; k < 8; ++k) {
    for (int j = 0; j < 10; ++j) {
      for (int i = 0; i < 12; ++i) {
        if (!box.contains(ct.geometry.to_patient(Vec3(i, j, k)))) continue;
        EXPECT_TRUE(i >= block.first[0] && i <= block.last[0] && j >= block.first[1] && j <= block.last[1] &&
                    k >= block.first[2] && k <= block.last[2]);
      }
    }
  }
  EXPECT_LT(block.last[0] - block.first[0], 8);  // sides of 2 mm, turned: at most 2.8 mm, 0.5 mm a voxel
}

TEST(Crop, LeavesAMarginAroundAMask) {
  const CtVolume ct = numbered_ct();
  BoneMask mask{ct.geometry, std::vector<std::uint8_t>(ct.hu.size(), 0)};
  mask.inside[ct.geometry.offset(6, 5, 4)] = 1;
  mask.inside[ct.geometry.offset(7, 5, 4)] = 1;
  const VoxelBlock block = block_around(mask, 1.0);
  EXPECT_THAT(block.first, ElementsAre(4, 4, 3));
  EXPECT_THAT(block.last, ElementsAre(9, 6, 5));
  const BoneMask cropped = crop(mask, block);
  EXPECT_TRUE(cropped.at(2, 1, 1));
  EXPECT_FALSE(cropped.at(1, 1, 1));
  EXPECT_EQ(cropped.geometry.origin_mm, crop(ct, block).geometry.origin_mm);
  EXPECT_THAT(block_around(mask, 1000.0).last, ElementsAre(11, 9, 7));
}

TEST(Crop, RejectsBoxesAndMasksThatHoldNothing) {
  const CtVolume ct = numbered_ct();
  const auto error = [&](const Vec3& low, const Vec3& high) {
    return test::error_of([&] { block_in_box(ct.geometry, Box3(low, high)); });
  };
  EXPECT_THAT(error(Vec3(100, 100, 100), Vec3(110, 110, 110)), HasSubstr("overlaps the CT"));
  EXPECT_THAT(error(Vec3(0, 0, 0), Vec3(-1, 1, 1)), HasSubstr("lower corner first"));
  EXPECT_THAT(error(Vec3(0, 0, NAN), Vec3(1, 1, 1)), HasSubstr("lower corner first"));
  const BoneMask empty{ct.geometry, std::vector<std::uint8_t>(ct.hu.size(), 0)};
  EXPECT_THAT(test::error_of([&] { block_around(empty, 1.0); }), HasSubstr("empty"));
  EXPECT_THAT(test::error_of([&] { crop(ct, {{0, 0, 0}, {12, 9, 7}}); }), HasSubstr("within the 12 voxels"));
}

}  // namespace
}  // namespace spinaltap
