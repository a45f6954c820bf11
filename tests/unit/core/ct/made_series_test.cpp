// Every kind of series, made with GDCM's writer, comes back voxel for voxel.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "core/ct/dicom_read.h"
#include "core/ct/read_ct.h"
#include "tests/support/made_series.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::MadeSeries;
using test::make_series;
using test::TemporaryFolder;

class MadeSeriesOf : public testing::TestWithParam<test::SeriesRecipe> {};

TEST_P(MadeSeriesOf, ComesBackVoxelForVoxel) {
  const MadeSeries series = make_series(GetParam());
  const TemporaryFolder folder;
  series.write(folder.path());
  const CtVolume ct = read_ct(folder.path());
  ASSERT_EQ(ct.geometry.size, series.ground_truth.geometry.size);
  // Decimals of a DICOM file have 16 characters.
  EXPECT_TRUE(ct.geometry.directions.isApprox(series.ground_truth.geometry.directions, 1e-9));
  EXPECT_LT((ct.geometry.origin_mm - series.ground_truth.geometry.origin_mm).norm(), 1e-8);
  EXPECT_LT((ct.geometry.spacing_mm - series.ground_truth.geometry.spacing_mm).norm(), 1e-8);
  int worst = 0;
  for (std::size_t n = 0; n < ct.hu.size(); ++n)
    worst = std::max(worst, std::abs(ct.hu[n] - series.ground_truth.hu[n]));
  EXPECT_LE(worst, series.tolerance_hu);
}

std::string letters(const testing::TestParamInfo<test::SeriesRecipe>& info) {
  std::string name;
  bool starts_word = true;
  for (const char c : info.param.name) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (is_plain) name.push_back(starts_word ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c);
    starts_word = !is_plain;
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(Every, MadeSeriesOf, testing::ValuesIn(test::every_kind_of_series()), letters);

TEST(ReadCt, TakesOneMultiFrameFileAsWellAsItsFolder) {
  const MadeSeries series = make_series({.name = "enhanced", .is_enhanced = true});
  const TemporaryFolder folder;
  series.write(folder.path());
  EXPECT_EQ(read_ct(folder.path() / series.files[0].name).source_hash, read_ct(folder.path()).source_hash);
}

TEST(ListDicomSeries, SaysHowManySlicesStandInAFileAndHowTheyLie) {
  const MadeSeries series =
      make_series({.name = "enhanced", .syntax = gdcm::TransferSyntax::RLELossless, .is_enhanced = true});
  const TemporaryFolder folder;
  series.write(folder.path());
  const std::vector<SeriesInfo> list = list_dicom_series(folder.path());
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0].files.size(), 1u);
  EXPECT_EQ(list[0].slices, 6);
  EXPECT_EQ(list[0].transfer_syntax, "RLE");
  ASSERT_TRUE(list[0].layout);
  EXPECT_EQ(plane_name(list[0].layout->directions.col(2)), "axial");
  EXPECT_EQ(list[0].layout->min_step_mm, 2.0);
  EXPECT_EQ(list[0].layout->max_step_mm, 2.0);
  EXPECT_EQ(list[0].layout->tilt_rad, 0.0);
}

}  // namespace
}  // namespace spinaltap
