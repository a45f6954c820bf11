#include "vdb/grid/spine_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/base/staged_output.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/cut_hole.h"
#include "tests/support/full_disk.h"
#include "tests/support/temporary_folder.h"
#include "vdb/bake/bake.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/vdb_file.h"
#include "vdb/grid/bone_hash.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr Level kThoracic11{18};

/// Two balls one above the other whose CT numbers overlap: each keeps 2 mm around it, and they lie 1 mm apart.
const test::Ball kUpper{Vec3(3.1, -2.3, 118.7), 6.0};
const test::Ball kLower{Vec3(2.6, -1.9, 105.7), 6.0};

const CtVolume& noisy_ct() {
  static const CtVolume ct = [] {
    constexpr std::uint64_t kSeed = 5;
    GridGeometry geometry;
    geometry.size = {40, 40, 30};
    geometry.spacing_mm = Vec3(0.6, 0.6, 1.3);
    geometry.origin_mm = Vec3(-9.0, -14.0, 94.0);
    std::vector<std::int16_t> hu;
    for (std::size_t v = 0; v < geometry.voxel_count(); ++v) {
      hu.push_back(static_cast<std::int16_t>(1500.0 * random_uniform(kSeed, v)));
    }
    return make_ct_volume(geometry, std::move(hu));
  }();
  return ct;
}

BoneModel baked(const test::Ball& ball, Level level, const CtVolume& ct = noisy_ct()) {
  return bake_bone(ball.field(), ball.surface_points(1.0), ct, {},
                   {{"source_hash", ct.source_hash}, {"level", level_name(level)}});
}

const std::vector<SpineBone>& two_bones() {
  static const std::vector<SpineBone> bones{
      {Level::kT12, baked(kLower, Level::kT12), {{"small", "a \"ball\" °"}, 0.25, "{\"frame\": \"LPS\"}", ""}},
      {kThoracic11, baked(kUpper, kThoracic11), {{}, 0.0, "", "no canal"}}};
  return bones;
}

/// As OpenVDB itself reads them.
openvdb::GridPtrVecPtr grids_in(const fs::path& path) {
  openvdb::io::File in(path.string());
  in.open();
  return in.getGrids();
}

void read_all(const fs::path& path) {
  for (const Level level : levels_in(path)) read_spine_level(path, level);
}

class SpineFile : public testing::Test {
 protected:
  fs::path file(const char* name) const { return folder_.path() / name; }
  fs::path written(const std::vector<SpineBone>& bones = two_bones()) const {
    write_spine(bones, file("spine.vdb"));
    return file("spine.vdb");
  }
  test::TemporaryFolder folder_;
};

void expect_same_grid(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b) {
  EXPECT_EQ(a.transform(), b.transform());
  EXPECT_EQ(a.background(), b.background());
  EXPECT_TRUE(a.tree().hasSameTopology(b.tree()));
  EXPECT_EQ(a.activeVoxelCount(), b.activeVoxelCount());
  for (auto value = a.cbeginValueOn(); value; ++value) {
    ASSERT_EQ(b.tree().getValue(value.getCoord()), *value) << value.getCoord();
  }
}

TEST_F(SpineFile, GivesEachBoneBackAsItWas) {
  const fs::path path = written();
  EXPECT_THAT(levels_in(path), ElementsAre(kThoracic11, Level::kT12));
  for (const SpineBone& one : two_bones()) {
    const SpineBone back = read_spine_level(path, one.level);
    expect_same_grid(*one.bone.grids().sdf, *back.bone.grids().sdf);
    expect_same_grid(*one.bone.grids().hu, *back.bone.grids().hu);
    EXPECT_EQ(bone_hash(back.bone), bone_hash(one.bone));
    EXPECT_EQ(back.bone.metadata(), one.bone.metadata());
    EXPECT_EQ(back.notes.warnings, one.notes.warnings);
    EXPECT_EQ(back.notes.severity, one.notes.severity);
    EXPECT_EQ(back.notes.landmarks, one.notes.landmarks);
    EXPECT_EQ(back.notes.no_landmarks, one.notes.no_landmarks);
  }
}

TEST_F(SpineFile, IsABoneAloneToThoseWhoTakeOne) {
  const fs::path path = written();
  write_bone(two_bones()[1].bone, file("alone.vdb"));
  const BoneModel alone = read_bone(file("alone.vdb"));
  const BoneModel of_spine = read_bone(path, kThoracic11);
  EXPECT_EQ(bone_hash(of_spine), bone_hash(alone));
  // Also where the other bone's CT numbers are, which it does not have.
  for (const Vec3& p : {kUpper.centre_mm, kLower.centre_mm, Vec3(0.5 * (kUpper.centre_mm + kLower.centre_mm))}) {
    EXPECT_EQ(test::hu_at(of_spine, p), test::hu_at(alone, p));
  }
}

TEST_F(SpineFile, KeepsTheNumbersThatBonesShareOnce) {
  const openvdb::GridPtrVecPtr grids = grids_in(written());
  std::vector<std::string> names;
  for (const auto& grid : *grids) names.push_back(grid->getName());
  EXPECT_THAT(names, testing::UnorderedElementsAre("sdf_T11", "part_T11", "sdf_T12", "part_T12", "hu"));
  openvdb::Index64 separate = 0;
  for (const SpineBone& one : two_bones()) separate += one.bone.grids().hu->activeVoxelCount();
  EXPECT_LT(openvdb::findGridByName(*grids, "hu")->activeVoxelCount(), separate);
}

TEST_F(SpineFile, HasTheSameBytesForTheSameBonesInAnyOrder) {
  const std::string bytes = read_whole_file(written());
  write_spine(std::vector<SpineBone>{two_bones()[1], two_bones()[0]}, file("again.vdb"));
  EXPECT_EQ(read_whole_file(file("again.vdb")), bytes);
}

TEST_F(SpineFile, AsksForAChoiceOfSeveralOnly) {
  EXPECT_THAT([&] { read_bone(written()); }, ThrowsMessage<Error>(AllOf(HasSubstr("several"), HasSubstr("T11, T12"))));
  EXPECT_THAT([&] { read_bone(written(), Level::kL1); },
              ThrowsMessage<Error>(AllOf(HasSubstr("no L1"), HasSubstr("T11, T12"))));
  EXPECT_EQ(bone_hash(read_bone(written({two_bones()[1]}))), bone_hash(two_bones()[1].bone));
}

TEST_F(SpineFile, HasABoneFileGiveTheLevelThatItRecords) {
  write_bone(two_bones()[1].bone, file("t11.vdb"));
  EXPECT_TRUE(levels_in(file("t11.vdb")).empty());
  EXPECT_NO_THROW(read_bone(file("t11.vdb"), kThoracic11));
  EXPECT_THAT([&] { read_bone(file("t11.vdb"), Level::kL1); },
              ThrowsMessage<Error>(HasSubstr("expected L1, found T11")));
  write_bone(test::bake_ball(test::kSmallBall), file("unknown.vdb"));
  EXPECT_THAT([&] { read_bone(file("unknown.vdb"), kThoracic11); }, ThrowsMessage<Error>(HasSubstr("not known")));
  EXPECT_THAT([&] { read_spine_level(file("t11.vdb"), kThoracic11); },
              ThrowsMessage<Error>(HasSubstr("several bones")));
}

TEST_F(SpineFile, RejectsBonesThatDoNotBelongTogether) {
  const auto rejected = [&](const std::vector<SpineBone>& bones, const char* why) {
    EXPECT_THAT([&] { write_spine(bones, file("no.vdb")); }, ThrowsMessage<Error>(HasSubstr(why))) << why;
    EXPECT_FALSE(fs::exists(file("no.vdb"))) << why;
  };
  const SpineBone& lower = two_bones()[0];
  SpineBone upper = two_bones()[1];
  rejected({}, "found none");
  rejected({lower, lower}, "T12 twice");
  upper.level = Level::kNone;
  rejected({lower, upper}, "expected a level");
  const CtVolume other = test::even_ct(kUpper.bounds_mm(), 1.0, 300);
  rejected({lower, {kThoracic11, baked(kUpper, kThoracic11, other), {}}}, "of one CT");
  const Pose pose{kUpper.centre_mm, Vec3::UnitZ()};
  rejected({{kThoracic11, test::without_hole(two_bones()[1].bone, DrillBit{}, pose, pose), {}}}, "drilled");
  upper = two_bones()[1];
  upper.notes.warnings = {"two\nlines"};
  rejected({upper}, "one line");
}

TEST_F(SpineFile, SaysWhatIsWrongWithADamagedFile) {
  const std::string whole = read_whole_file(written());
  for (const double share : {0.0, 0.01, 0.3, 0.6, 0.9, 0.9999}) {
    const auto keep = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
    write_whole_file(file("cut.vdb"), whole.substr(0, keep));
    EXPECT_THAT([&] { read_all(file("cut.vdb")); }, ThrowsMessage<Error>(HasSubstr("cut.vdb"))) << keep << " bytes";
  }
  write_whole_file(file("cut.vdb"), whole.substr(0, whole.size() - 1));
  EXPECT_THROW(read_all(file("cut.vdb")), Error);
  EXPECT_THAT([&] { levels_in(file("none.vdb")); }, ThrowsMessage<Error>(HasSubstr("no such file")));
}

TEST_F(SpineFile, SaysWhichGridOrListIsMissing) {
  const openvdb::GridPtrVecPtr grids = grids_in(written());
  const auto with = [&](const std::string& levels, const std::string& without) {
    openvdb::GridCPtrVec some;
    for (const auto& grid : *grids) {
      if (grid->getName() != without) some.push_back(grid);
    }
    openvdb::MetaMap metadata;
    metadata.insertMeta("spinaltap:levels", openvdb::StringMetadata(levels));
    detail::write_vdb(file("made.vdb"), some, metadata);
    return file("made.vdb");
  };
  for (const char* name : {"sdf_T12", "part_T12", "hu"}) {
    const fs::path path = with("T11 T12", name);
    EXPECT_THAT([&] { read_all(path); }, ThrowsMessage<Error>(HasSubstr(name))) << name;
  }
  EXPECT_EQ(read_spine_level(with("T11 T12", "sdf_T12"), kThoracic11).level,
            kThoracic11);  // what is not asked for may miss
  for (const char* list : {"T11 T44", "T11 T11", "Th11", ""}) {
    EXPECT_THAT([&] { levels_in(with(list, "")); }, ThrowsMessage<Error>(HasSubstr("list of levels"))) << list;
  }
}

TEST_F(SpineFile, SaysWhenTheDiskIsFull) {
  const std::uintmax_t size = fs::file_size(written());
  for (const std::uintmax_t room : {size / 2, size - 1}) {
    const test::FullDisk full(room);
    EXPECT_THAT([&] { write_spine(two_bones(), file("full.vdb")); }, ThrowsMessage<Error>(HasSubstr("disk full")))
        << room << " bytes";
  }
}

}  // namespace
}  // namespace spinaltap
