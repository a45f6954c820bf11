#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/base/staged_output.h"
#include "core/ct/dicom_write.h"
#include "core/files/json_file.h"
#include "tests/cli/program.h"
#include "tests/support/labelled_balls.h"
#include "tests/support/temporary_folder.h"
#include "vdb/grid/bone_hash.h"
#include "vdb/grid/spine_file.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A CT of three balls, a map of them, and the spine.vdb that `bake --all` makes of both.
class Levels : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    const test::LabelledBalls balls;
    std::filesystem::create_directory(in("ct"));
    write_dicom(balls.ct, in("ct"));
    write_whole_file(in("map.seg.nrrd"), encode_label_volume(balls.labels, "map.seg.nrrd"));
    LabelVolume unnamed = balls.labels;
    unnamed.names.clear();
    write_whole_file(in("map.nrrd"), encode_label_volume(unnamed, "map.nrrd"));
    baked_ = run("bake ct --labels map.seg.nrrd --all --voxel 0.5 -o spine.vdb --json baked.json");
  }
  static void TearDownTestSuite() { delete folder_; }
  void SetUp() override { ASSERT_EQ(baked_.exit_code, 0) << baked_.errors; }

  static test::ProgramRun run(const std::string& arguments) {
    return test::run_program(arguments + " --force", folder_->path());
  }
  static std::filesystem::path in(const std::string& name) { return folder_->path() / name; }

  static const test::TemporaryFolder* folder_;
  static test::ProgramRun baked_;
};

const test::TemporaryFolder* Levels::folder_ = nullptr;
test::ProgramRun Levels::baked_;

TEST_F(Levels, BakesAllThatTheCtHoldsWholeAndTellsWhatItLeftOut) {
  EXPECT_THAT(baked_.output, AllOf(HasSubstr("T11"), HasSubstr("T12"), HasSubstr("left out: cut by the CT's border")));
  const Json figures = read_json(in("baked.json"));
  ASSERT_EQ(figures["levels"].size(), 2U);
  EXPECT_EQ(figures["levels"][0]["level"], "T11");
  EXPECT_EQ(figures["skipped"][0]["level"], "L1");
  EXPECT_EQ(level_names(levels_in(in("spine.vdb"))), "T11, T12");
  EXPECT_FALSE(std::filesystem::exists(in("spine.vdb.cache")));
}

TEST_F(Levels, BakesIntoAFolderAndAloneTheSameBones) {
  ASSERT_EQ(run("bake ct --labels map.seg.nrrd --all --voxel 0.5 --cache cache -o bones").exit_code, 0);
  ASSERT_EQ(run("bake ct --labels map.seg.nrrd --label T12 --voxel 0.5 --cache cache -o t12.vdb").exit_code, 0);
  const BoneModel of_spine = read_bone(in("spine.vdb"), Level::kT12);
  EXPECT_EQ(bone_hash(read_bone(in("t12.vdb"))), bone_hash(of_spine));
  EXPECT_EQ(bone_hash(read_bone(in("bones/T12.vdb"))), bone_hash(of_spine));
  EXPECT_TRUE(std::filesystem::exists(in("bones/T11.vdb")));
  EXPECT_EQ(run("info t12.vdb --level T12").exit_code, 0);
  EXPECT_THAT(run("info t12.vdb --level T11").errors, HasSubstr("expected T11, found T12"));
}

TEST_F(Levels, BakesOneThatTheCtsBorderCutsWithAWarningThatItsGradesCarry) {
  const test::ProgramRun cut = run("bake ct --labels map.seg.nrrd --label L1 --voxel 0.5 -o cut.vdb --json cut.json");
  EXPECT_EQ(cut.exit_code, 1);
  EXPECT_THAT(cut.output, HasSubstr("cut by the CT's border"));
  EXPECT_THAT(read_json(in("cut.json"))["warnings"].dump(), HasSubstr("cut by the CT's border"));
  EXPECT_EQ(run("bake ct --labels map.seg.nrrd --label L1 --voxel 0.5 -o cut.vdb --accept-warnings").exit_code, 0);
  const test::ProgramRun info = run("info cut.vdb");
  EXPECT_THAT(info.output, HasSubstr("cut by the CT's border"));
  const test::ProgramRun drawn = run("render cut.vdb -o cut.png --json drawn.json");
  EXPECT_EQ(drawn.exit_code, 0) << drawn.errors;
  EXPECT_THAT(drawn.output, HasSubstr("this bone is SUSPECT: cut by the CT's border"));
  EXPECT_THAT(read_json(in("drawn.json"))["bone_warnings"].dump(), HasSubstr("cut by the CT's border"));
}

TEST_F(Levels, WarnsOfALabelThatWasMoved) {
  LabelVolume moved = test::LabelledBalls().labels;
  moved.geometry.origin_mm.x() += 2.0;
  write_whole_file(in("moved.seg.nrrd"), encode_label_volume(moved, "moved.seg.nrrd"));
  const test::ProgramRun warned = run("bake ct --labels moved.seg.nrrd --label T12 --voxel 0.5 -o moved.vdb");
  EXPECT_EQ(warned.exit_code, 1);
  EXPECT_THAT(warned.output, HasSubstr("looks moved by"));
  EXPECT_THAT(run("bake ct --labels moved.seg.nrrd --all --voxel 0.5 -o moved.vdb").output,
              HasSubstr("looks moved by"));
}

TEST_F(Levels, WritesNothingWhereItMustNotLeaveOneOut) {
  const test::ProgramRun strict = run("bake ct --labels map.seg.nrrd --all --strict --voxel 0.5 -o strict.vdb");
  EXPECT_EQ(strict.exit_code, 2);
  EXPECT_THAT(strict.errors, HasSubstr("L1: cut by the CT's border"));
  EXPECT_FALSE(std::filesystem::exists(in("strict.vdb")));
}

TEST_F(Levels, TakesTheConventionThatIsSaid) {
  // Balls of 10 mm have the size of no vertebra: nothing tells what their numbers mean.
  for (const char* label : {"T12", "19"}) {
    const test::ProgramRun unsaid = run(std::string("bake ct --labels map.nrrd --voxel 0.5 -o u.vdb --label ") + label);
    EXPECT_EQ(unsaid.exit_code, 2);
    EXPECT_THAT(unsaid.errors, AllOf(HasSubstr("19 is T12 in VerSe"), HasSubstr("convention")));
    EXPECT_FALSE(std::filesystem::exists(in("u.vdb")));
  }
  const test::ProgramRun open = run("bake ct --labels map.nrrd --label 19 --convention none --voxel 0.5 -o open.vdb");
  EXPECT_EQ(open.exit_code, 0) << open.errors;
  EXPECT_FALSE(read_bone(in("open.vdb")).metadata().contains("level"));
  const test::ProgramRun verse =
      run("bake ct --labels map.nrrd --label T12 --convention verse --voxel 0.5 --cache cache -o v.vdb");
  EXPECT_EQ(verse.exit_code, 0) << verse.errors;
  EXPECT_THAT(verse.output, HasSubstr("numbers as of VerSe, as was said"));
  EXPECT_EQ(read_bone(in("v.vdb")).metadata().at("level_source"), "numbers as of VerSe, as was said");
  const test::ProgramRun other =
      run("bake ct --labels map.nrrd --label L4 --convention totalsegmentator_v1 --voxel 0.5 --cache cache -o o.vdb");
  EXPECT_EQ(other.exit_code, 0) << other.errors;
  EXPECT_EQ(bone_hash(read_bone(in("o.vdb"), Level{23})), bone_hash(read_bone(in("v.vdb"), Level::kT12)));
  EXPECT_THAT(run("bake ct --labels map.nrrd --all --convention names -o n.vdb").errors, HasSubstr("names vertebrae"));
  EXPECT_EQ(run("bake ct --labels map.nrrd --convention mine").exit_code, 2);
  EXPECT_THAT(run("bake ct --labels map.nrrd --label best").errors, HasSubstr("a vertebra such as L3"));
}

TEST_F(Levels, CommandsTakeOneBoneOfSeveral) {
  for (const char* command : {"mesh spine.vdb -o x.stl", "render spine.vdb -o x.png",
                              "plan spine.vdb --entry 10,-9,32 --target 10,-4,32 -o plan.json"}) {
    const test::ProgramRun unsaid = run(command);
    EXPECT_EQ(unsaid.exit_code, 2) << command;
    EXPECT_THAT(unsaid.errors, HasSubstr("T11, T12")) << command;
    const test::ProgramRun said = run(std::string(command) + " --level T12");
    EXPECT_EQ(said.exit_code, 0) << command << said.errors;
    EXPECT_THAT(run(std::string(command) + " --level L1").errors, HasSubstr("no L1 in")) << command;
    EXPECT_EQ(run(std::string(command) + " --level 12").exit_code, 2) << command;
  }
  // A path through T12 is none through T11.
  EXPECT_THAT(run("plan spine.vdb --entry 10,-9,32 --target 10,-4,32 -o x.json --level T11").errors,
              HasSubstr("misses the bone"));
  const test::ProgramRun drilled =
      run("drill spine.vdb plan.json --level T12 --step 0.5 --spacing 0.4 --no-clearances --full-mesh --no-pictures "
          "--record r.h5 -o drilled");
  EXPECT_EQ(drilled.exit_code, 0) << drilled.errors;
  EXPECT_EQ(run("replay r.h5 spine.vdb --level T12").exit_code, 0);
  EXPECT_EQ(run("replay r.h5 spine.vdb --level T11").exit_code, 2);
}

TEST_F(Levels, InfoListsThem) {
  const test::ProgramRun info = run("info spine.vdb --json info.json");
  ASSERT_EQ(info.exit_code, 0) << info.errors;
  EXPECT_THAT(info.output, HasSubstr("T11, T12"));
  const Json figures = read_json(in("info.json"));
  ASSERT_EQ(figures["levels"].size(), 2U);
  EXPECT_EQ(figures["levels"][1]["level"], "T12");
  EXPECT_NE(figures["levels"][1]["no_landmarks"], "");
  EXPECT_EQ(figures["levels"][1]["metadata"]["level"], "T12");
}

}  // namespace
}  // namespace spinaltap
