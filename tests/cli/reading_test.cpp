// Reading CTs from the command line: what info shows, contact sheets, cropping, resampling, and no patient's name.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/staged_output.h"
#include "core/files/json_file.h"
#include "tests/cli/program.h"
#include "tests/support/hand_made_dicom.h"
#include "tests/support/made_nifti.h"
#include "tests/support/made_series.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::run_program;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

class Reading : public testing::Test {
 protected:
  void write_series(const test::SeriesRecipe& recipe = {}) {
    fs::create_directory(folder_.path() / "ct");
    make_series(recipe).write(folder_.path() / "ct");
  }
  /// Runs the program and gives its figures. Made series hold neither air nor fat, of which it warns.
  Json figures_of(const std::string& arguments) {
    const test::ProgramRun run =
        run_program(arguments + " --force --accept-warnings --json figures.json", folder_.path());
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_EQ(run.errors, "");
    output_ = run.output;
    return Json::parse(read_whole_file(folder_.path() / "figures.json"));
  }

  test::TemporaryFolder folder_;
  std::string output_;
};

TEST_F(Reading, ShowsHowASeriesIsStoredAndHowItsSlicesLie) {
  write_series({.name = "", .syntax = gdcm::TransferSyntax::RLELossless});
  const Json series = figures_of("info ct").at("series").at(0);
  EXPECT_THAT(output_, AllOf(HasSubstr("CT, 6 slices of 20 x 16 in 6 files"), HasSubstr("RLE"),
                             HasSubstr("axial, columns grow to L, rows to P")));
  EXPECT_EQ(series.at("plane"), "axial");
  EXPECT_EQ(series.at("transfer_syntax"), "RLE");
  EXPECT_EQ(series.at("min_step_mm"), 2.0);
  EXPECT_EQ(series.at("tilt_deg"), 0.0);
}

TEST_F(Reading, NeverShowsAPatientsNameOrNumber) {
  write_series();
  figures_of("info ct --contact-sheet sheet.png");
  const test::ProgramRun several = run_program("info ct --series 9", folder_.path());
  for (const std::string& text : {output_, several.errors, read_whole_file(folder_.path() / "figures.json"),
                                  read_whole_file(folder_.path() / "sheet.png")}) {
    EXPECT_FALSE(text.empty());
    EXPECT_THAT(text, AllOf(Not(HasSubstr("Secret")), Not(HasSubstr("SECRET"))));
  }
}

TEST_F(Reading, WritesAContactSheetOfBoundedSize) {
  write_series();
  figures_of("info ct --contact-sheet sheet.png");
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&header, (folder_.path() / "sheet.png").c_str()), 0);
  EXPECT_GT(header.width, 500u);
  EXPECT_LE(header.width, 1400u);
  EXPECT_LE(header.height, 1400u);
  png_image_free(&header);
}

TEST_F(Reading, TakesANiftiFileWhereverACtIsWanted) {
  test::MadeNifti nifti;
  nifti.dim = {3, 30, 30, 30, 1, 1, 1, 1};
  for (int k = 0; k < 30; ++k) {
    for (int j = 0; j < 30; ++j) {
      for (int i = 0; i < 30; ++i) {
        nifti.values.push_back((Vec3(i, j, k) - Vec3::Constant(14.5)).norm() < 9.0 ? 600.0 : 40.0);
      }
    }
  }
  write_whole_file(folder_.path() / "ct.nii.gz", test::gzipped(nifti.bytes()));
  EXPECT_EQ(figures_of("info ct.nii.gz").at("ct").at("highest_hu"), 600);
  for (double& value : nifti.values) value = value > 320.0 ? 1.0 : 0.0;
  write_whole_file(folder_.path() / "ball.nii.gz", test::gzipped(nifti.bytes()));
  const Json baked = figures_of("bake ct.nii.gz --labels ball.nii.gz --voxel 0.5 -o bone.vdb");
  // The grid reaches 1.5 mm beyond the surface.
  EXPECT_NEAR(baked.at("size_mm").at(0).get<double>(), 18.0 + 3.0, 0.6);
}

TEST_F(Reading, CropsToABoxInThePatient) {
  write_series();
  // Voxels of 0.5 x 0.75 x 2 mm from (-30.5, 12.25, 100).
  const Json ct = figures_of("info ct --crop=-29.6,13,102,-27.9,17,106.5").at("ct");
  EXPECT_THAT(ct.at("size"), ElementsAre(4, 6, 3));
  EXPECT_THAT(ct.at("origin_mm"), ElementsAre(-29.5, 13.0, 102.0));
  const test::ProgramRun run = run_program("info ct --crop=0,0,0,1,1,1", folder_.path());
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("overlaps the CT"));
}

TEST_F(Reading, ResamplesUnequalStepsOnlyWhenAskedTo) {
  fs::create_directory(folder_.path() / "ct");
  const std::vector<double> z_mm{0, 2, 4, 7, 9};
  for (std::size_t k = 0; k < z_mm.size(); ++k) {
    test::HandMadeDicom slice;
    slice.set_z(z_mm[k]);
    write_whole_file(folder_.path() / "ct" / ("slice" + std::to_string(k)), slice.bytes());
  }
  const test::ProgramRun run = run_program("info ct", folder_.path());
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, AllOf(HasSubstr("between slice2 and"), HasSubstr("slice3 (--resample interpolates)")));
  const Json figures = figures_of("info ct --resample");
  EXPECT_THAT(figures.at("ct").at("size"), ElementsAre(4, 3, 5));
  EXPECT_EQ(figures.at("series").at(0).at("max_step_mm"), 3.0);
}

TEST_F(Reading, ResamplesATiltedGantryAndSaysTheAngle) {
  fs::create_directory(folder_.path() / "ct");
  for (int k = 0; k < 5; ++k) {
    test::HandMadeDicom slice;
    slice.set(0x00200032, "DS", "0\\" + std::to_string(0.5 * k) + "\\" + std::to_string(2.0 * k));
    write_whole_file(folder_.path() / "ct" / ("slice" + std::to_string(k)), slice.bytes());
  }
  const Json figures = figures_of("info ct");
  EXPECT_NEAR(figures.at("series").at(0).at("tilt_deg").get<double>(), 14.04, 0.01);
  EXPECT_THAT(figures.at("ct").at("size"), ElementsAre(4, 7, 5));  // rows of 0.5 mm, four more
}

}  // namespace
}  // namespace spinaltap
