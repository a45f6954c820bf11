// Bad input gets one line that says what was expected and found, a non-zero exit, and leaves no file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nifti1.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "core/base/staged_output.h"
#include "core/ct/dicom_read.h"
#include "core/ct/dicom_write.h"
#include "core/ct/label_map.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::everything_in;
using test::ProgramRun;
using test::run_program;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
namespace fs = std::filesystem;

constexpr int kCtSide = 32;
constexpr const char* kBakeCt = "bake ct --labels ball.nrrd --voxel 0.5";

/// A ball of bone (radius 10 mm, 600 HU) in soft tissue, around (16, 16, 16) mm.
CtVolume ball_ct(double spacing_mm = 1.0) {
  GridGeometry geometry;
  geometry.size = {kCtSide, kCtSide, kCtSide};
  geometry.spacing_mm = Vec3::Constant(spacing_mm);
  std::vector<std::int16_t> hu(geometry.voxel_count());
  for (int k = 0; k < kCtSide; ++k) {
    for (int j = 0; j < kCtSide; ++j) {
      for (int i = 0; i < kCtSide; ++i) {
        const double depth = 10.0 - (Vec3(i, j, k) - Vec3::Constant(16.0)).norm();
        hu[geometry.offset(i, j, k)] = static_cast<std::int16_t>(40.0 + 560.0 * std::clamp(depth + 0.5, 0.0, 1.0));
      }
    }
  }
  return make_ct_volume(geometry, std::move(hu));
}

/// A label map of the ball, which is no vertebra that could be found.
std::string ball_map() {
  const CtVolume ct = ball_ct();
  BoneMask mask{ct.geometry, std::vector<std::uint8_t>(ct.hu.size())};
  for (std::size_t v = 0; v < mask.inside.size(); ++v) mask.inside[v] = ct.hu[v] >= 320 ? 1 : 0;
  return encode_label_map(mask, 1, "ball.nrrd");
}

/// A label map over the ball's CT in which every voxel is 5.
void write_labels(const fs::path& file) {
  nifti_1_header header{};
  header.sizeof_hdr = sizeof header;
  header.dim[0] = 3;
  for (int axis = 1; axis <= 3; ++axis) header.dim[axis] = kCtSide;
  header.datatype = DT_UINT8;
  header.bitpix = 8;
  for (int axis = 0; axis <= 3; ++axis) header.pixdim[axis] = 1.0F;
  header.vox_offset = 352.0F;
  header.sform_code = 1;
  header.srow_x[0] = -1.0F;  // RAS: x and y are the negative of LPS
  header.srow_y[1] = -1.0F;
  header.srow_z[2] = 1.0F;
  std::memcpy(header.magic, "n+1", 4);
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(&header), sizeof header);
  out.write("\0\0\0\0", 4);
  out << std::string(static_cast<std::size_t>(kCtSide) * kCtSide * kCtSide, '\5');
}

class Errors : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    made_ = new test::TemporaryFolder;
    fs::create_directory(made_->path() / "ct");
    write_dicom(ball_ct(), made_->path() / "ct");
    write_whole_file(made_->path() / "ball.nrrd", ball_map());
    const ProgramRun run = run_program(std::string(kBakeCt) + " -o bone.vdb", made_->path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
  }
  static void TearDownTestSuite() { delete made_; }

  void SetUp() override {
    fs::copy(made_->path() / "ct", folder_.path() / "ct");
    fs::copy(made_->path() / "ball.nrrd", folder_.path());
    fs::create_directory(folder_.path() / "work");
  }

  fs::path in(const std::string& name) const { return folder_.path() / name; }
  fs::path work() const { return folder_.path() / "work"; }

  /// Runs the program in the empty folder work/, and expects one line of error, an exit that is not 0, and no file.
  std::string rejected(const std::string& arguments, const std::string& before = "") {
    const ProgramRun run = run_program(arguments + " --force", work(), before);
    EXPECT_NE(run.exit_code, 0) << arguments;
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
    EXPECT_THAT(run.errors, ::testing::StartsWith("spinaltap: "));
    EXPECT_LT(run.errors.size(), 600U) << run.errors;
    EXPECT_THAT(everything_in(work()), IsEmpty()) << arguments;
    return run.errors;
  }

  /// Puts the baked ball into the test's folder.
  void take_bone() { fs::copy(made_->path() / "bone.vdb", folder_.path()); }

  static const test::TemporaryFolder* made_;  ///< a CT in ct/, ball.nrrd, and bone.vdb
  test::TemporaryFolder folder_;
};

const test::TemporaryFolder* Errors::made_ = nullptr;

TEST_F(Errors, NamesAFolderThatIsMissing) {
  EXPECT_THAT(rejected("bake ../nowhere -o out/bone.vdb"), HasSubstr("no such folder: ../nowhere"));
}

TEST_F(Errors, SaysThatAFolderHoldsNoDicom) {
  fs::create_directory(in("notes"));
  std::ofstream(in("notes/readme.txt")) << "nothing here";
  EXPECT_THAT(rejected("bake ../notes -o out/bone.vdb"), HasSubstr("expected DICOM images, found none"));
}

TEST_F(Errors, NamesTheModalityOfASeriesThatIsNotCt) {
  const std::string ct_element(
      "\x08\x00\x60\x00"
      "CS\x02\x00"
      "CT",
      10);
  const std::string mr_element(
      "\x08\x00\x60\x00"
      "CS\x02\x00"
      "MR",
      10);
  for (const auto& entry : fs::directory_iterator(in("ct"))) {
    std::ostringstream text;
    text << std::ifstream(entry.path(), std::ios::binary).rdbuf();
    std::string bytes = text.str();
    const std::size_t at = bytes.find(ct_element);
    ASSERT_NE(at, std::string::npos);
    bytes.replace(at, ct_element.size(), mr_element);
    std::ofstream(entry.path(), std::ios::binary) << bytes;
  }
  EXPECT_THAT(rejected("bake ../ct -o out/bone.vdb"), HasSubstr("MR"));
}

TEST_F(Errors, NamesTheNeighboursOfAMissingSlice) {
  fs::remove(in("ct/0009.dcm"));
  const std::string error = rejected("bake ../ct -o out/bone.vdb");
  EXPECT_THAT(error, HasSubstr("a slice is missing: expected a step of 1 mm, found 2 mm"));
  EXPECT_THAT(error, HasSubstr("0008.dcm"));
  EXPECT_THAT(error, HasSubstr("0010.dcm"));
}

TEST_F(Errors, ListsTheSeriesOfAMixedFolder) {
  fs::create_directory(in("ct/second"));
  write_dicom(ball_ct(0.5), in("ct/second"));
  const std::string error = rejected("bake ../ct -o out/bone.vdb");
  EXPECT_THAT(error, HasSubstr("expected one series, found 2"));
  EXPECT_THAT(error, HasSubstr("--series"));
  EXPECT_THAT(error, HasSubstr("1 = "));
  EXPECT_THAT(error, HasSubstr("2 = "));
  EXPECT_THAT(rejected("bake ../ct --series 3 -o out/bone.vdb"), HasSubstr("3"));
}

TEST_F(Errors, ListsTheLabelsOfAMapWithoutTheOneAskedFor) {
  write_labels(in("labels.nii"));
  const std::string error = rejected("bake ../ct --labels ../labels.nii --label 7 -o out/bone.vdb");
  EXPECT_THAT(error, HasSubstr("no label 7"));
  EXPECT_THAT(error, HasSubstr("there are: 5"));
}

TEST_F(Errors, SaysWhatIsWrongWithASeed) {
  EXPECT_THAT(rejected("segment ../ct --seed-point 16,16,400 -o out/map.nii.gz"),
              HasSubstr("expected a point in the CT"));
  EXPECT_THAT(rejected("bake ../ct --seed-point 16,16,400 -o out/bone.vdb"), HasSubstr("expected a point in the CT"));
  EXPECT_THAT(rejected("segment ../ct --seed-point 1,2,3 -o out/map.nii.gz"), HasSubstr("around (1, 2, 3) mm"));
  EXPECT_THAT(rejected("segment ../ct --seed-point 1,2 -o out/map.nii.gz"), HasSubstr("--help"));
}

TEST_F(Errors, NamesALabelMapThatIsNone) {
  std::ofstream(in("bad.nrrd")) << "not NRRD at all";
  EXPECT_THAT(rejected("segment ../ct --labels ../bad.nrrd -o out/map.nii.gz"),
              ::testing::AllOf(HasSubstr("expected an NRRD file"), HasSubstr("bad.nrrd")));
  EXPECT_THAT(rejected("bake ../ct --labels ../nowhere.nrrd -o out/bone.vdb"), HasSubstr("no such file"));
  EXPECT_THAT(rejected("segment ../ct -o out/map.png"), HasSubstr("map.png"));
}

TEST_F(Errors, LeavesNeitherMapNorPictureOnAFullDisk) {
  write_labels(in("labels.nii"));
  const std::string segment = "segment ../ct --labels ../labels.nii --label 5 -o out/map.nii --picture out/map.png";
  EXPECT_THAT(rejected(segment, "ulimit -f 8;"), HasSubstr("cannot write"));
}

TEST_F(Errors, CarriesALabelMapFromOneFormatToAnotherAndBack) {
  write_labels(in("labels.nii"));
  const auto run = [&](const std::string& arguments) {
    const ProgramRun done = run_program("segment ct " + arguments, folder_.path());
    EXPECT_EQ(done.exit_code, 0) << done.errors;
    EXPECT_THAT(done.output, HasSubstr("32768"));  // every voxel of the CT
  };
  run("--accept-warnings --labels labels.nii --label 5 --write-label 300 -o work/map.seg.nrrd --picture work/map.png");
  run("--accept-warnings --labels work/map.seg.nrrd --label 300 -o work/map.nii.gz");
  EXPECT_THAT(everything_in(work()), ::testing::ElementsAre("map.nii.gz", "map.png", "map.seg.nrrd"));
}

TEST_F(Errors, SaysWhereAPathRunsThatMissesTheBone) {
  take_bone();
  const std::string error = rejected("plan ../bone.vdb --entry 100,0,0 --target 130,0,0 -o out/plan.json");
  EXPECT_THAT(error, HasSubstr("misses the bone"));
  EXPECT_THAT(error, HasSubstr("(100, 0, 0) to (130, 0, 0)"));
  std::ofstream(in("plan.json"))
      << R"({"format": "spinaltap-plan", "version": 2, "frame": "LPS", "unit": "mm", "paths": [
    {"name": "far", "entry_mm": [100, 0, 0], "target_mm": [130, 0, 0],
     "bit": {"diameter_mm": 3, "length_mm": 50, "tip_length_mm": 5}}]})";
  EXPECT_THAT(rejected("drill ../bone.vdb ../plan.json -o out"), HasSubstr("misses the bone"));
}

TEST_F(Errors, NamesFileAndKeyOfABadPlan) {
  take_bone();
  std::ofstream(in("plan.json"))
      << R"({"format": "spinaltap-plan", "version": 2, "frame": "LPS", "unit": "mm", "paths": [
    {"name": "p", "entry_mm": [1, 2], "target_mm": [3, 0, 0], "bit": {}}]})";
  const std::string error = rejected("drill ../bone.vdb ../plan.json -o out");
  EXPECT_THAT(error, HasSubstr("\"entry_mm\""));
  EXPECT_THAT(error, HasSubstr("plan.json"));
}

TEST_F(Errors, LeavesNothingOfAnyOutputOnAFullDisk) {
  take_bone();
  std::ofstream(in("plan.json"))
      << R"({"format": "spinaltap-plan", "version": 2, "frame": "LPS", "unit": "mm", "paths": [
    {"name": "p", "entry_mm": [16, 26, 16], "target_mm": [16, 10, 16],
     "bit": {"diameter_mm": 3, "length_mm": 50, "tip_length_mm": 5}}]})";
  // A limit on the size of a file makes writes fail as a full disk does.
  const std::string small = "ulimit -f 8;";
  EXPECT_THAT(rejected("bake ../ct --labels ../ball.nrrd --voxel 0.5 -o out/bone.vdb", small),
              HasSubstr("cannot write"));
  EXPECT_THAT(rejected("mesh ../bone.vdb -o out/bone.stl", small), HasSubstr("cannot write"));
  EXPECT_THAT(rejected("drill ../bone.vdb ../plan.json --step 0.05 -o out", small), HasSubstr("cannot write"));
  EXPECT_THAT(rejected("phantom out --slices 3 --slice-step 5", small), HasSubstr("cannot write"));
}

TEST_F(Errors, KeepsTheOldFileWhenTheDiskIsFull) {
  take_bone();
  const auto size = fs::file_size(in("bone.vdb"));
  const ProgramRun run = run_program(std::string(kBakeCt) + " -o bone.vdb --force", folder_.path(), "ulimit -f 8;");
  EXPECT_NE(run.exit_code, 0);
  EXPECT_EQ(fs::file_size(in("bone.vdb")), size);
}

TEST_F(Errors, RejectsAnUnknownOptionWithAWordAboutHelp) {
  EXPECT_THAT(rejected("bake ../ct --colour red"), HasSubstr("--help"));
  EXPECT_THAT(rejected("drill"), HasSubstr("--help"));
}

TEST(Help, ShowsUnitsAndAnExampleForEverySubcommand) {
  const test::TemporaryFolder folder;
  for (const char* name : {"demo", "phantom", "info", "segment", "points", "fit", "eval", "bake", "plan", "drill",
                           "link", "mesh", "diff", "compare", "replay", "sound", "validate"}) {
    const ProgramRun run = run_program(std::string(name) + " --help", folder.path());
    EXPECT_EQ(run.exit_code, 0) << name;
    EXPECT_THAT(run.output, HasSubstr("Example")) << name;
    EXPECT_THAT(run.output, HasSubstr("--json")) << name;
    EXPECT_THAT(run.output, HasSubstr("--force")) << name;
    EXPECT_THAT(run.output, HasSubstr("--threads")) << name;
    EXPECT_THAT(run.output, Not(HasSubstr("->"))) << name << ": values are named, not numbered";
  }
}

TEST_F(Errors, NothingThatIsWrittenTellsWhoseCtItIs) {
  fs::rename(in("ct"), in("jane_doe"));
  fs::rename(in("ball.nrrd"), in("jane_doe.nrrd"));
  const std::vector<SeriesInfo> series = list_dicom_series(in("jane_doe"));
  ASSERT_EQ(series.size(), 1U);
  for (
      const char* arguments :
      {"info ../jane_doe --json info.json --contact-sheet ct.png",
       "bake ../jane_doe --labels ../jane_doe.nrrd --voxel 0.5 --cache cache -o bone.vdb --json bake.json",
       "demo ../jane_doe --labels ../jane_doe.nrrd --voxel 0.5 --entry 16,26,16 --target 16,18,16 --radius 2 --spacing "
       "0.2 --step 0.02 -o demo --json demo.json",
       "drill bone.vdb demo/plan.json --ct ../jane_doe --radius 2 --spacing 0.2 --step 0.02 --record run.h5 -o drilled "
       "--json drill.json",
       "segment ../jane_doe --labels ../jane_doe.nrrd -o map.seg.nrrd --picture map.png --json segment.json"}) {
    const ProgramRun run = run_program(arguments, work());
    EXPECT_EQ(run.exit_code, 0) << arguments << "\n" << run.errors;
  }
  const std::vector<std::string> names = everything_in(work());
  EXPECT_GE(names.size(), 20U);
  for (const std::string& name : names) {
    EXPECT_THAT(name, Not(HasSubstr("jane_doe")));
    if (!fs::is_regular_file(work() / name)) continue;
    const std::string content = read_whole_file(work() / name);
    EXPECT_EQ(content.find("jane_doe"), std::string::npos) << name;
    EXPECT_EQ(content.find(series.front().uid), std::string::npos) << name;
  }
}

TEST_F(Errors, ADemonstrationWithoutAFolderLeavesAnEarlierOneAlone) {
  fs::create_directory(in("spinaltap-demo"));
  write_whole_file(in("spinaltap-demo/report.html"), "years of work");
  const std::string demo =
      "demo ct --labels ball.nrrd --voxel 0.5 --entry 16,26,16 --target 16,18,16 --radius 2 --spacing 0.2 --step 0.02 "
      "--no-pictures";
  for (const char* folder : {"spinaltap-demo-2", "spinaltap-demo-3"}) {
    const ProgramRun run = run_program(demo, folder_.path());
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_THAT(run.output, HasSubstr("open  " + (in(folder) / "report.html").string() + "\n"));
    EXPECT_THAT(run.output, HasSubstr("drill " + std::string(folder) + "/bone.vdb"));
    EXPECT_TRUE(fs::exists(in(folder) / "files.txt"));
  }
  EXPECT_EQ(read_whole_file(in("spinaltap-demo/report.html")), "years of work");
  const ProgramRun named = run_program(demo + " -o spinaltap-demo", folder_.path());
  EXPECT_EQ(named.exit_code, 2);
  EXPECT_THAT(named.errors, HasSubstr("is there already"));
}

TEST_F(Errors, PrintsNoProgressIntoAPipe) {
  const ProgramRun run = run_program(std::string(kBakeCt) + " -o work/bone.vdb --json work/bake.json", folder_.path());
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.errors, IsEmpty());
  EXPECT_THAT(everything_in(work()), ::testing::ElementsAre("bake.json", "bone.vdb"));
}

}  // namespace
}  // namespace spinaltap
