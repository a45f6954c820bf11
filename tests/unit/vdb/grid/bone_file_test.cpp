#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <sys/stat.h>
#include <tbb/global_control.h>

#include <fstream>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/cut_hole.h"
#include "tests/support/full_disk.h"
#include "tests/support/temporary_folder.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/vdb_file.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using test::kSmallBall;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// A bone whose CT numbers differ, some of them beyond those that a half float holds.
BoneModel bone_of_many_hu() {
  GridGeometry geometry;
  geometry.size = {40, 40, 24};
  geometry.spacing_mm = Vec3(0.5, 0.5, 1.0);
  geometry.origin_mm = kSmallBall.centre_mm - Vec3(10.0, 10.0, 12.0);
  std::vector<std::int16_t> hu;
  for (std::size_t i = 0; i < geometry.voxel_count(); ++i)
    hu.push_back(static_cast<std::int16_t>(i * 37 % 4096 - 1024));
  return bake_bone(kSmallBall.field(), kSmallBall.surface_points(1.0), make_ct_volume(geometry, std::move(hu)), {},
                   {{"source_hash", "0123"}, {"method", "ball, \"quoted\" Grad °"}, {"empty", ""}});
}

BoneModel drilled_bone() {
  const Vec3 axis = Vec3(0.3, 0.5, 0.7).normalized();
  const Pose pose{kSmallBall.centre_mm, axis};
  return test::without_hole(bone_of_many_hu(), DrillBit{}, pose, pose);
}

class BoneFile : public testing::Test {
 protected:
  fs::path file(const char* name) const { return folder_.path() / name; }
  fs::path folder() const { return folder_.path(); }

  /// A file with the given grids, written by OpenVDB itself.
  fs::path foreign_file(const openvdb::GridPtrVec& grids) const {
    openvdb::io::File out(file("foreign.vdb").string());
    out.write(grids);
    out.close();
    return file("foreign.vdb");
  }

  void SetUp() override { initialize_openvdb(); }

 private:
  test::TemporaryFolder folder_;
};

void expect_equal_grids(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b) {
  EXPECT_EQ(a.transform(), b.transform());
  EXPECT_EQ(a.background(), b.background());
  EXPECT_EQ(a.activeVoxelCount(), b.activeVoxelCount());
  EXPECT_TRUE(a.tree().hasSameTopology(b.tree()));
  auto other = b.getConstAccessor();
  for (auto value = a.cbeginValueAll(); value; ++value) {
    ASSERT_EQ(*value, other.getValue(value.getCoord())) << value.getCoord();
  }
}

TEST_F(BoneFile, GivesBackGridsAndMetadataBitForBit) {
  const BoneModel bone = bone_of_many_hu();
  write_bone(bone, file("bone.vdb"));
  const BoneModel back = read_bone(file("bone.vdb"));
  expect_equal_grids(*bone.grids().sdf, *back.grids().sdf);
  expect_equal_grids(*bone.grids().hu, *back.grids().hu);
  EXPECT_EQ(back.metadata(), bone.metadata());
  EXPECT_EQ(back.band_mm(), bone.band_mm());
  EXPECT_EQ(back.voxel_mm(), bone.voxel_mm());
}

TEST_F(BoneFile, IsALevelSetAndAnHuGridToOtherPrograms) {
  write_bone(bone_of_many_hu(), file("bone.vdb"));
  openvdb::io::File in(file("bone.vdb").string());
  in.open();
  EXPECT_EQ(in.getGrids()->size(), 2U);
  EXPECT_EQ(in.readGrid("sdf")->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_TRUE(in.readGrid("hu")->saveFloatAsHalf());
  EXPECT_TRUE(in.readGrid("sdf")->saveFloatAsHalf());
}

TEST_F(BoneFile, GivesBackAlsoWhatHalfFloatsDoNotHold) {
  // Most distances from a bit are no half floats.
  const BoneModel drilled = drilled_bone();
  write_bone(drilled, file("drilled.vdb"));
  const BoneModel back = read_bone(file("drilled.vdb"));
  expect_equal_grids(*drilled.grids().sdf, *back.grids().sdf);
  ASSERT_TRUE(is_drilled(back));
  expect_equal_grids(*drilled.grids().before, *back.grids().before);
  expect_equal_grids(*drilled.grids().hole, *back.grids().hole);
}

TEST_F(BoneFile, IsRejectedWithHalfOfWhatADrilledBoneHas) {
  const BoneModel drilled = drilled_bone();
  detail::BoneGrids half = drilled.grids();
  const auto write = [&](const char* name, const openvdb::FloatGrid& grid, openvdb::GridCPtrVec& grids) {
    const auto copy = grid.deepCopy();
    copy->setName(name);
    grids.push_back(copy);
  };
  openvdb::GridCPtrVec grids;
  write("sdf", *half.sdf, grids);
  write("hu", *half.hu, grids);
  write("hole", *half.hole, grids);
  detail::write_vdb(file("half.vdb"), grids);
  EXPECT_THAT([&] { read_bone(file("half.vdb")); },
              ThrowsMessage<Error>(AllOf(HasSubstr("half.vdb"), HasSubstr("before and hole"))));
  // On other voxels than the bone's.
  const auto moved = half.before->deepCopy();
  moved->setTransform(openvdb::math::Transform::createLinearTransform(1.0));
  write("before", *moved, grids);
  detail::write_vdb(file("moved.vdb"), grids);
  EXPECT_THAT([&] { read_bone(file("moved.vdb")); },
              ThrowsMessage<Error>(AllOf(HasSubstr("moved.vdb"), HasSubstr("before"))));
}

TEST_F(BoneFile, HasTheSameBytesInTwoRunsAndAtOneAndTwoThreads) {
  const auto bytes_of = [&](const char* name) {
    write_bone(bone_of_many_hu(), file(name));
    return read_whole_file(file(name));
  };
  const std::string first = bytes_of("first.vdb");
  EXPECT_EQ(first, bytes_of("second.vdb"));
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(first, bytes_of("one.vdb"));
  }
  const tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
  EXPECT_EQ(first, bytes_of("two.vdb"));
}

TEST_F(BoneFile, IsRejectedWhenCutShortAnywhere) {
  write_bone(bone_of_many_hu(), file("bone.vdb"));
  const std::string whole = read_whole_file(file("bone.vdb"));
  // Through the head, the descriptors, the trees and the last byte.
  for (std::size_t keep = 0; keep < whole.size(); keep += keep < 2000 ? 37 : whole.size() / 60) {
    std::ofstream(file("cut.vdb"), std::ios::binary | std::ios::trunc) << whole.substr(0, keep);
    EXPECT_THAT([&] { read_bone(file("cut.vdb")); }, ThrowsMessage<Error>(HasSubstr("cut.vdb"))) << keep << " bytes";
  }
  std::ofstream(file("cut.vdb"), std::ios::binary | std::ios::trunc) << whole.substr(0, whole.size() - 1);
  EXPECT_THROW(read_bone(file("cut.vdb")), Error);
}

TEST_F(BoneFile, IsRejectedWhenItIsNoVdbFile) {
  std::ofstream(file("text.vdb")) << "no grids here\n";
  EXPECT_THAT([&] { read_bone(file("text.vdb")); }, ThrowsMessage<Error>(HasSubstr("text.vdb")));
}

TEST_F(BoneFile, IsRejectedWhenItIsNoFile) {
  EXPECT_THAT([&] { read_bone(file("none.vdb")); }, ThrowsMessage<Error>(HasSubstr("no such file")));
  EXPECT_THAT([&] { read_bone(folder()); }, ThrowsMessage<Error>(HasSubstr("something else")));
  ASSERT_EQ(::mkfifo(file("pipe.vdb").c_str(), 0600), 0);
  EXPECT_THAT([&] { read_bone(file("pipe.vdb")); }, ThrowsMessage<Error>(HasSubstr("something else")));
}

TEST_F(BoneFile, IsRejectedWithoutItsTwoGrids) {
  const BoneModel bone = bone_of_many_hu();
  const auto sdf = bone.grids().sdf->deepCopy();
  const auto hu = bone.grids().hu->deepCopy();
  EXPECT_THAT([&] { read_bone(foreign_file({sdf})); }, ThrowsMessage<Error>(HasSubstr("found no hu")));
  EXPECT_THAT([&] { read_bone(foreign_file({hu})); }, ThrowsMessage<Error>(HasSubstr("found no sdf")));
}

TEST_F(BoneFile, IsRejectedWithGridsOfAnotherKind) {
  const BoneModel bone = bone_of_many_hu();
  const auto sdf = bone.grids().sdf->deepCopy();
  const auto hu = bone.grids().hu->deepCopy();
  const auto whole_numbers = openvdb::Int32Grid::create(0);
  whole_numbers->setName("hu");
  EXPECT_THAT([&] { read_bone(foreign_file({sdf, whole_numbers})); }, ThrowsMessage<Error>(HasSubstr("floats")));
  const auto empty = openvdb::FloatGrid::create(0.75F);
  empty->setName("sdf");
  empty->setGridClass(openvdb::GRID_LEVEL_SET);
  EXPECT_THAT([&] { read_bone(foreign_file({empty, hu})); }, ThrowsMessage<Error>(HasSubstr("not empty")));
  const auto fog = sdf->deepCopy();
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  EXPECT_THAT([&] { read_bone(foreign_file({fog, hu})); }, ThrowsMessage<Error>(HasSubstr("level set")));
}

TEST_F(BoneFile, IsRejectedWithVoxelsThatAreNoCubes) {
  // Distances in mm need one step along all axes.
  const BoneModel bone = bone_of_many_hu();
  const auto stretched = bone.grids().sdf->deepCopy();
  openvdb::Mat4d matrix = openvdb::Mat4d::identity();
  matrix[0][0] = matrix[1][1] = 0.25;
  stretched->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  EXPECT_THAT(
      [&] {
        read_bone(foreign_file({stretched, bone.grids().hu->deepCopy()}));
      },
      ThrowsMessage<Error>(HasSubstr("voxels")));
}

TEST_F(BoneFile, IsNotLeftBehindOnAFullDisk) {
  const BoneModel bone = bone_of_many_hu();
  write_bone(bone, file("whole.vdb"));
  const auto size = fs::file_size(file("whole.vdb"));
  fs::remove(file("whole.vdb"));
  // Full from the start, in the middle, and at the last byte, which OpenVDB's own writer does not notice.
  for (const std::uintmax_t room : {std::uintmax_t{16}, size / 2, size - 1}) {
    StagedOutput output;
    const fs::path staged = output.stage(file("bone.vdb"));
    const test::FullDisk full(room);
    EXPECT_THAT([&] { write_bone(bone, staged); }, ThrowsMessage<Error>(HasSubstr("cannot write"))) << room;
  }
  EXPECT_TRUE(fs::is_empty(folder()));
}

TEST_F(BoneFile, IsNotWrittenIntoAMissingFolder) {
  EXPECT_THAT([&] { write_bone(bone_of_many_hu(), file("missing") / "bone.vdb"); },
              ThrowsMessage<Error>(HasSubstr("cannot write")));
}

}  // namespace
}  // namespace spinaltap
