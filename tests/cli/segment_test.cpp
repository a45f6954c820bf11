#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/base/staged_output.h"
#include "core/ct/dicom_source.h"
#include "core/ct/label_volume.h"
#include "core/ct/read_ct.h"
#include "core/files/json_file.h"
#include "tests/cli/program.h"
#include "tests/support/made_nifti.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kScan = " --pixel 1 --size 160 --slice-step 1.5 --slice-width 1.5";

/// A coarse CT of L2 to L4 of the phantom, whose ground truth is known, and the map of all that `segment --all` makes
/// of it.
class Segment : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    made_ = run(std::string("phantom spine --spine L2-L4") + kScan);
    if (made_.exit_code == 0) made_ = run("segment spine/ct --all --level L3=0,0,0 --accept-warnings -o all.seg.nrrd");
  }
  static void TearDownTestSuite() { delete folder_; }
  void SetUp() override { ASSERT_EQ(made_.exit_code, 0) << made_.errors; }

  static test::ProgramRun run(const std::string& arguments) {
    return test::run_program(arguments + " --force", folder_->path());
  }
  static fs::path in(const std::string& name) { return folder_->path() / name; }
  static GridGeometry grid() { return read_ct(in("spine/ct")).geometry; }
  static LabelVolume map(const std::string& name) { return read_label_volume(in(name), grid()); }

  /// The level of the voxel that a point lies in.
  static Level level_at(const LabelVolume& map, const Vec3& p_mm) {
    const Eigen::Vector3i p = map.geometry.to_index(p_mm).array().round().cast<int>();
    const auto found = map.names.find(map.labels[map.geometry.offset(p.x(), p.y(), p.z())]);
    return found == map.names.end() ? Level::kNone : found->second.level;
  }

  /// Middle of the spinous process of L3, by the phantom's ground truth: 8 mm in front of the tip.
  static Vec3 in_spinous_process() {
    const Json tip = read_json(in("spine/ground_truth.json"))["levels"][1]["spinous_tip_mm"];
    return Vec3(tip[0].get<double>(), tip[1].get<double>() - 8.0, tip[2].get<double>() + 1.0);
  }
  static std::string whole(const std::string& name) {
    std::ostringstream bytes;
    bytes << std::ifstream(in(name)).rdbuf();
    return bytes.str();
  }
  static std::string text_of(const Vec3& p) {
    std::ostringstream text;
    text << p.x() << ',' << p.y() << ',' << p.z();
    return text.str();
  }

  static const test::TemporaryFolder* folder_;
  static test::ProgramRun made_;
};

const test::TemporaryFolder* Segment::folder_ = nullptr;
test::ProgramRun Segment::made_;

TEST_F(Segment, WritesAllLevelsUnderTheirNames) {
  EXPECT_THAT(made_.output, AllOf(HasSubstr("counted from L3=0,0,0"), HasSubstr("L2  "), HasSubstr("L4  "),
                                  HasSubstr("GB of memory at most): read ")));
  const LabelVolume found = map("all.seg.nrrd");
  EXPECT_EQ(levels_of(found), (std::vector{Level{21}, Level{22}, Level{23}}));
  const Json ground_truth = read_json(in("spine/ground_truth.json"))["levels"];
  for (const Json& level : ground_truth) {
    const Json p = level["body_centre_mm"];
    const Vec3 centre_mm(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
    EXPECT_EQ(level_name(level_at(found, centre_mm)), level["level"].get<std::string>());
  }
}

TEST_F(Segment, WritesOneVertebraWithAPictureAndAllFigures) {
  const test::ProgramRun one =
      run("segment spine/ct --level L3=0,0,0 --accept-warnings -o one.seg.nrrd --picture one.png --json one.json");
  ASSERT_EQ(one.exit_code, 0) << one.errors;
  EXPECT_THAT(one.output, HasSubstr("counted from L3=0,0,0"));
  const LabelVolume found = map("one.seg.nrrd");
  EXPECT_EQ(levels_of(found), std::vector{Level{22}});
  EXPECT_EQ(found.names.begin()->first, 22);
  const Json json = read_json(in("one.json"));
  EXPECT_EQ(json["level"], "L3");
  EXPECT_EQ(json["label"], 22);
  EXPECT_EQ(json["name_source"], "given");
  // The phantom's L3 is centred at the origin; a voxel is 1.5 mm high.
  EXPECT_LT(std::abs(json["body_centre_mm"][2].get<double>()), 3.0);
  for (const char* key : {"body_size_mm", "body_axes", "body_fit", "cut_area_mm2", "figures", "warnings", "severity",
                          "is_cut", "reaches_border", "volume_mm3", "threshold_hu", "noise_hu", "ct_hash"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_TRUE(fs::exists(in("one.png")));
}

TEST_F(Segment, CountsWithoutAWordFromTheTop) {
  const test::ProgramRun unnamed =
      run("segment spine/ct --seed-point 0,0,0 --accept-warnings -o v.seg.nrrd --json v.json");
  ASSERT_EQ(unnamed.exit_code, 0) << unnamed.errors;
  EXPECT_THAT(unnamed.output, AllOf(HasSubstr("counted from the top"), HasSubstr("V2")));
  EXPECT_EQ(read_json(in("v.json"))["label"], 1);
  const test::ProgramRun baking = run("bake spine/ct --all -o none.vdb");
  EXPECT_EQ(baking.exit_code, 2);
  EXPECT_THAT(baking.errors, AllOf(HasSubstr("--level"), HasSubstr("V1 at"), HasSubstr("V3 at")));
  EXPECT_FALSE(fs::exists(in("none.vdb")));
}

TEST_F(Segment, FollowsCorrections) {
  const Vec3 p_mm = in_spinous_process();
  ASSERT_EQ(level_at(map("all.seg.nrrd"), p_mm), Level{22});
  const std::string all = "segment spine/ct --all --level L3=0,0,0 --accept-warnings ";
  ASSERT_EQ(run(all + "--exclude=" + text_of(p_mm) + " -o without.seg.nrrd").exit_code, 0);
  // One point inside bone moves borders only: what it takes out is filled as cancellous bone is. Strokes take more.
  EXPECT_NE(whole("without.seg.nrrd"), whole("all.seg.nrrd"));
  ASSERT_EQ(run(all + "--include L4=" + text_of(p_mm) + " -o other.seg.nrrd").exit_code, 0);
  EXPECT_NE(whole("other.seg.nrrd"), whole("all.seg.nrrd"));
}

TEST_F(Segment, FollowsStrokes) {
  const Vec3 p_mm = in_spinous_process();
  // A small map of its own: 4 mm of the process are painted away.
  LabelVolume strokes;
  strokes.geometry.size = {4, 4, 4};
  strokes.geometry.spacing_mm = Vec3::Ones();
  strokes.geometry.origin_mm = p_mm - Vec3::Constant(1.5);
  strokes.labels.assign(64, 7);
  strokes.names = {{7, {"exclude", Level::kNone}}};
  write_whole_file(in("strokes.seg.nrrd"), encode_label_volume(strokes, "strokes.seg.nrrd"));
  const test::ProgramRun done =
      run("segment spine/ct --all --level L3=0,0,0 --accept-warnings --strokes strokes.seg.nrrd -o painted.seg.nrrd");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_EQ(level_at(map("painted.seg.nrrd"), p_mm), Level::kNone);
}

TEST_F(Segment, CopiesAllLevelsOfAForeignMap) {
  LabelVolume foreign = map("all.seg.nrrd");
  // As TotalSegmentator 2 numbers L2 to L4.
  for (std::uint8_t& label : foreign.labels) {
    label = static_cast<std::uint8_t>(label >= 21 && label <= 23 ? 51 - label : 0);
  }
  foreign.names = {{30, {"", Level::kNone}}, {29, {"", Level::kNone}}, {28, {"", Level::kNone}}};
  write_whole_file(in("foreign.nrrd"), encode_label_volume(foreign, "foreign.nrrd"));
  const test::ProgramRun copied =
      run("segment spine/ct --all --labels foreign.nrrd --convention totalsegmentator -o copied.seg.nrrd");
  ASSERT_EQ(copied.exit_code, 0) << copied.errors;
  const LabelVolume found = map("copied.seg.nrrd");
  EXPECT_EQ(levels_of(found), (std::vector{Level{21}, Level{22}, Level{23}}));
  EXPECT_EQ(level_at(found, Vec3::Zero()), Level{22});
}

TEST_F(Segment, WritesDicomThatNamesItsCtAndIsReadAgain) {
  const std::vector<std::uint8_t> labels = map("all.seg.nrrd").labels;
  const DicomSource source = find_dicom_source(in("spine/ct"), "", 0, grid());
  for (const char* name : {"spine.dcm", "spine.rtstruct.dcm"}) {
    const std::string command = std::string("segment spine/ct --all --labels all.seg.nrrd -o ") + name;
    const test::ProgramRun written = run(command);
    ASSERT_EQ(written.exit_code, 0) << written.errors;
    const std::string bytes = whole(name);
    EXPECT_THAT(bytes, AllOf(HasSubstr(source.study_uid), HasSubstr(source.frame_of_reference_uid)));
    EXPECT_THAT(bytes, HasSubstr(source.slices[static_cast<std::size_t>(grid().size[2] / 2)]->sop_instance));
    const LabelVolume back = map(name);
    EXPECT_EQ(levels_of(back), (std::vector{Level{21}, Level{22}, Level{23}}));
    std::size_t other = 0;
    for (std::size_t v = 0; v < labels.size(); ++v) {
      const auto found = back.names.find(back.labels[v]);
      const int level = found == back.names.end() ? 0 : static_cast<int>(found->second.level);
      if (level != (labels[v] >= 21 && labels[v] <= 23 ? labels[v] : 0)) ++other;
    }
    EXPECT_EQ(other, 0U) << name;
    ASSERT_EQ(run(command + " --no-ct-references").exit_code, 0);
    EXPECT_THAT(whole(name), Not(HasSubstr(source.study_uid)));
  }
}

TEST_F(Segment, TellsASuspectVertebraByItsExitCodeWithAllWritten) {
  // Screws in the pedicles: CT numbers around metal are not bone's.
  ASSERT_EQ(run(std::string("phantom metal --spine L2-L4 --metal L3") + kScan).exit_code, 0);
  const test::ProgramRun suspect = run("segment metal/ct --level L3=0,0,0 -o metal.seg.nrrd --json metal.json");
  EXPECT_EQ(suspect.exit_code, 1);
  EXPECT_THAT(suspect.output, AllOf(HasSubstr("metal"), HasSubstr("suspect"), HasSubstr("--accept-warnings"),
                                    HasSubstr("add --picture warnings.png")));
  EXPECT_TRUE(fs::exists(in("metal.seg.nrrd")));
  EXPECT_EQ(read_json(in("metal.json"))["is_suspect"], true);
  EXPECT_EQ(run("segment metal/ct --level L3=0,0,0 --accept-warnings -o metal.seg.nrrd").exit_code, 0);

  const test::ProgramRun baked =
      run("bake metal/ct --level L3=0,0,0 --voxel 1 --point-spacing 3 --cache cache -o bone.vdb --json bone.json");
  EXPECT_EQ(baked.exit_code, 1) << baked.errors;
  EXPECT_THAT(baked.output, AllOf(HasSubstr("metal"), HasSubstr("L3: the exit code is 1")));
  EXPECT_GE(read_json(in("bone.json"))["severity"].get<double>(), 0.5);
  const test::ProgramRun info = run("info bone.vdb --json info.json");
  EXPECT_THAT(info.output, AllOf(HasSubstr("warning"), HasSubstr("metal"), HasSubstr("severity")));
  EXPECT_EQ(read_json(in("info.json"))["warnings"], read_json(in("bone.json"))["warnings"]);
  // The cached mask is as suspect.
  const test::ProgramRun again =
      run("bake metal/ct --level L3=0,0,0 --voxel 1 --point-spacing 3 --cache cache -o again.vdb --json again.json");
  EXPECT_EQ(again.exit_code, 1);
  const Json json = read_json(in("again.json"));
  EXPECT_EQ(json["mask_from_cache"], true);
  EXPECT_EQ(json["warnings"], read_json(in("bone.json"))["warnings"]);
  EXPECT_EQ(json["level"], "L3");
}

TEST_F(Segment, BakesTheLevelsThatItFinds) {
  const test::ProgramRun baked = run(
      "bake spine/ct --all --level L3=0,0,0 --crop=-80,-80,-60,80,80,25 --voxel 1 --point-spacing 3 --accept-warnings"
      " -o spine.vdb --json spine.json");
  ASSERT_EQ(baked.exit_code, 0) << baked.errors;
  EXPECT_THAT(baked.output, HasSubstr("counted from L3=0,0,0"));
  const Json json = read_json(in("spine.json"));
  ASSERT_FALSE(json["levels"].empty());
  EXPECT_TRUE(json["levels"][0].contains("severity"));
  EXPECT_THAT(run("info spine.vdb").output, HasSubstr("L3"));
}

// Soft tissue without any bone: whoever looks at the slices sees why.
TEST_F(Segment, ShowsTheCtWhereItFindsNothing) {
  test::MadeNifti soft;
  soft.dim = {3, 40, 40, 30, 1, 1, 1, 1};
  soft.values.assign(40 * 40 * 30, 45.0);
  std::ofstream(in("soft.nii"), std::ios::binary) << soft.bytes();
  const test::ProgramRun asked = run("segment soft.nii -o none.seg.nrrd --picture soft.png");
  EXPECT_EQ(asked.exit_code, 2);
  EXPECT_THAT(asked.errors, AllOf(HasSubstr("no voxel over the bone threshold"), HasSubstr("slices in soft.png")));
  EXPECT_THAT(whole("soft.png"), HasSubstr("PNG"));
  EXPECT_FALSE(fs::exists(in("none.seg.nrrd")));
  EXPECT_THAT(run("segment soft.nii --all -o none.seg.nrrd").errors, HasSubstr("--picture"));
}

TEST_F(Segment, SaysWhatIsWrongWithPointsAndNames) {
  const auto error = [&](const std::string& options) {
    const test::ProgramRun rejected = run("segment spine/ct " + options + " -o rejected.nrrd");
    EXPECT_EQ(rejected.exit_code, 2) << options;
    EXPECT_FALSE(fs::exists(in("rejected.nrrd"))) << options;
    return rejected.errors;
  };
  const Json disc = read_json(in("spine/ground_truth.json"))["discs"][0]["centre_mm"];
  const Vec3 in_disc(disc[0].get<double>(), disc[1].get<double>(), disc[2].get<double>());
  EXPECT_THAT(error("--seed-point " + text_of(in_disc)), HasSubstr("expected a point in a vertebral body"));
  EXPECT_THAT(error("--level L3=0,0,0 --level L2=0,0,-38"), HasSubstr("agrees with L3"));
  EXPECT_THAT(error("--level L3=0,0"), HasSubstr("X,Y,Z"));
  EXPECT_THAT(error("--level 0,0,0"), HasSubstr("T11=X,Y,Z"));
  EXPECT_THAT(error("--include bone=0,0,0"), HasSubstr("found bone"));
  EXPECT_THAT(error("--labels all.seg.nrrd --seed-point 0,0,0"), HasSubstr("--help"));
  EXPECT_THAT(error("--all --write-label 3"), Not(HasSubstr("written")));
}

}  // namespace
}  // namespace spinaltap
