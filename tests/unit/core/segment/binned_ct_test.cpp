#include "core/segment/detail/binned_ct.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace spinaltap {
namespace {

CtVolume ramp_ct() {
  GridGeometry geometry;
  geometry.size = {7, 4, 3};
  geometry.spacing_mm = Vec3(0.4, 0.4, 1.0);
  geometry.origin_mm = Vec3(10.0, 20.0, 30.0);
  geometry.directions = Eigen::AngleAxisd(0.4, Vec3(1, 2, 2).normalized()).toRotationMatrix();
  std::vector<std::int16_t> hu;
  for (int n = 0; n < 7 * 4 * 3; ++n)
    hu.push_back(static_cast<std::int16_t>(10 * (n % 7) + n / 7 % 4 + 100 * (n / 28)));
  return make_ct_volume(geometry, std::move(hu));
}

TEST(BinHu, GivesTheMeanAtTheMiddleOfEachBlock) {
  const CtVolume ct = ramp_ct();
  const FloatGrid grid = bin_hu(ct, {{1, 0, 0}, {6, 3, 2}}, {2, 2, 1});
  EXPECT_EQ(grid.geometry.size, (std::array<int, 3>{3, 2, 3}));
  // The ramp is linear, so the mean is its value in the middle of the block.
  EXPECT_FLOAT_EQ(grid.at(0, 0, 0), 15.5F);
  EXPECT_FLOAT_EQ(grid.at(2, 1, 2), 10.0F * 5.5F + 2.5F + 200.0F);
  EXPECT_LT((grid.geometry.to_patient(Vec3(2, 1, 2)) - ct.geometry.to_patient(Vec3(5.5, 2.5, 2.0))).norm(), 1e-9);
}

TEST(BinHu, AveragesWhatIsLeftInTheLastBlock) {
  EXPECT_FLOAT_EQ(bin_hu(ramp_ct(), {{0, 0, 0}, {6, 3, 2}}, {4, 4, 3}).at(1, 0, 0), 50.0F + 1.5F + 100.0F);
}

TEST(BinHu, RejectsABoxBeyondTheCt) {
  EXPECT_THROW(bin_hu(ramp_ct(), {{0, 0, 0}, {7, 3, 2}}, {1, 1, 1}), Error);
  EXPECT_THROW(bin_hu(ramp_ct(), VoxelBox{}, {1, 1, 1}), Error);
}

TEST(BinsFor, BringVoxelsNearTheStepAndNeverSplitThem) {
  GridGeometry geometry;
  geometry.spacing_mm = Vec3(0.352, 0.78, 3.0);
  EXPECT_EQ(bins_for(geometry, 0.8), (std::array<int, 3>{2, 1, 1}));
}

TEST(VoxelsOf, AreThoseOfTheCtThatABoxTouches) {
  GridGeometry geometry;
  geometry.size = {10, 10, 10};
  const VoxelBox box = voxels_of(Box3(Vec3(2.3, -5.0, 8.0), Vec3(4.2, 1.0, 30.0)), geometry);
  EXPECT_EQ(box.low, (std::array<int, 3>{2, 0, 8}));
  EXPECT_EQ(box.high, (std::array<int, 3>{5, 1, 9}));
  EXPECT_TRUE(voxels_of(Box3(Vec3::Constant(20.0), Vec3::Constant(30.0)), geometry).empty());
}

}  // namespace
}  // namespace spinaltap
