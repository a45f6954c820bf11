#include "vdb/grid/bone_hash.h"

#include <gtest/gtest.h>
#include <openvdb/tools/ValueTransformer.h>

#include "tests/support/made_bone.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

BoneModel hashed_ball(double radius_mm = 4.0) {
  return test::made_bone([=](const Vec3& p) { return p.norm() - radius_mm; },
                         {Vec3::Constant(-20.0), Vec3::Constant(20.0)}, 0.5);
}

/// A copy whose grids `change` has been at.
BoneModel changed(const BoneModel& bone,
                  const std::function<void(openvdb::FloatGrid& sdf, openvdb::FloatGrid& hu)>& change) {
  auto grids = std::make_shared<detail::BoneGrids>();
  const openvdb::FloatGrid::Ptr sdf = bone.grids().sdf->deepCopy();
  const openvdb::FloatGrid::Ptr hu = bone.grids().hu->deepCopy();
  change(*sdf, *hu);
  grids->sdf = sdf;
  grids->hu = hu;
  return BoneModel(grids);
}

TEST(BoneHash, IsThatOfTheGridsHoweverTheyAreKept) {
  const BoneModel bone = hashed_ball();
  const std::string hash = bone_hash(bone);
  EXPECT_EQ(hash.size(), 16U);
  EXPECT_EQ(bone_hash(hashed_ball()), hash);

  // The CT numbers are tiles of one value here: as voxels they are the same.
  ASSERT_GT(bone.grids().hu->tree().activeTileCount(), 0U);
  EXPECT_EQ(bone_hash(changed(bone,
                              [](auto& sdf, auto& hu) {
                                sdf.tree().voxelizeActiveTiles();
                                hu.tree().voxelizeActiveTiles();
                                sdf.setName("another name");
                              })),
            hash);

  const test::TemporaryFolder folder;
  write_bone(bone, folder.path() / "bone.vdb");
  EXPECT_EQ(bone_hash(read_bone(folder.path() / "bone.vdb")), hash);
}

TEST(BoneHash, IsAnotherWhereOneValueOrPlaceIs) {
  const BoneModel bone = hashed_ball();
  const std::string hash = bone_hash(bone);
  EXPECT_NE(bone_hash(hashed_ball(4.001)), hash);
  EXPECT_NE(bone_hash(changed(bone, [](auto& /*sdf*/, auto& hu) { hu.tree().setValueOn({1, 2, 3}, 301.0F); })), hash);
  EXPECT_NE(bone_hash(changed(bone, [](auto& sdf, auto& /*hu*/) { sdf.tree().setValueOff({8, 0, 0}); })), hash);
  EXPECT_NE(bone_hash(changed(bone,
                              [](auto& sdf, auto& /*hu*/) {
                                sdf.setTransform(openvdb::math::Transform::createLinearTransform(0.51));
                              })),
            hash);
}

}  // namespace
}  // namespace spinaltap
