// Label maps written as DICOM segmentations and structure sets, and read again.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/random.h"
#include "core/base/staged_output.h"
#include "core/ct/dicom_source.h"
#include "core/ct/label_volume.h"
#include "core/ct/read_ct.h"
#include "tests/support/error_of.h"
#include "tests/support/hand_made_dicom.h"
#include "tests/support/made_series.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using test::HandMadeDicom;
using test::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

/// Blobs and lone voxels of several labels, holes and touching corners among them, on a turned grid. 13 x 11 pixels a
/// slice: frames begin within bytes.
LabelVolume patchy_volume() {
  constexpr std::uint64_t kSeed = 43;
  LabelVolume volume;
  volume.geometry.size = {13, 11, 9};
  volume.geometry.spacing_mm = Vec3(0.352, 0.352, 0.5);
  volume.geometry.origin_mm = Vec3(-101.25, 33.7, -679.8);
  volume.geometry.directions = Eigen::AngleAxisd(0.6, Vec3(1, -2, 2).normalized()).toRotationMatrix();
  for (std::size_t v = 0; v < volume.geometry.voxel_count(); ++v) {
    const double random = random_uniform(kSeed, v);
    const std::size_t k = v / 143;
    // L4 has no voxel in the middle slices, which are left out of a segmentation.
    volume.labels.push_back(random < 0.4 ? 18 : random < 0.6 && (k < 3 || k > 6) ? 23 : random > 0.9 ? 50 : 0);
  }
  volume.names = {{18, {"T11", Level{18}}}, {23, {"L4", Level{23}}}, {50, {"left rib", Level::kNone}}};
  return volume;
}

/// The names of the voxels' labels: numbers may become others.
std::vector<std::string> names_of_voxels(const LabelVolume& map) {
  std::vector<std::string> names;
  for (const std::uint8_t label : map.labels) names.push_back(label == 0 ? "" : map.names.at(label).name);
  return names;
}

class WrittenDicomLabels : public testing::TestWithParam<std::string> {};

TEST_P(WrittenDicomLabels, ComeBackVoxelForVoxel) {
  const LabelVolume volume = patchy_volume();
  const TemporaryFolder folder;
  const std::string bytes = encode_label_volume(volume, GetParam());
  EXPECT_EQ(encode_label_volume(volume, GetParam()), bytes);
  write_whole_file(folder.path() / GetParam(), bytes);
  const LabelVolume back = read_label_volume(folder.path() / GetParam(), volume.geometry);
  EXPECT_EQ(names_of_voxels(back), names_of_voxels(volume));
  EXPECT_EQ(levels_of(back), levels_of(volume));
}

// What a vertebra's mask holds: the 0.98 that is asked of contours on slices of 1 mm is 1.0 on the grid itself.
TEST_P(WrittenDicomLabels, OfAnotherGridComeBackWithinAVoxel) {
  LabelVolume ball;
  ball.geometry.size = {60, 60, 50};
  ball.geometry.spacing_mm = Vec3(0.7, 0.7, 1.0);
  for (int k = 0; k < 50; ++k) {
    for (int j = 0; j < 60; ++j) {
      for (int i = 0; i < 60; ++i) {
        const double r = (ball.geometry.to_patient(Vec3(i, j, k)) - Vec3(20.0, 21.0, 24.0)).norm();
        ball.labels.push_back(r < 17.0 && r > 5.0 ? 20 : 0);
      }
    }
  }
  ball.names = {{20, {"L1", Level::kL1}}};
  const TemporaryFolder folder;
  write_whole_file(folder.path() / GetParam(), encode_label_volume(ball, GetParam()));
  GridGeometry finer = ball.geometry;
  finer.size = {120, 120, 100};
  finer.spacing_mm *= 0.5;
  const LabelVolume back = read_label_volume(folder.path() / GetParam(), finer);
  double both = 0.0, sum = 0.0;
  std::size_t at = 0;
  for (int k = 0; k < 100; ++k) {
    for (int j = 0; j < 120; ++j) {
      for (int i = 0; i < 120; ++i) {
        const double r = (finer.to_patient(Vec3(i, j, k)) - Vec3(20.0, 21.0, 24.0)).norm();
        const bool is_in = r < 17.0 && r > 5.0;
        const bool is_read = back.labels[at++] != 0;
        both += is_in && is_read ? 2.0 : 0.0;
        sum += (is_in ? 1.0 : 0.0) + (is_read ? 1.0 : 0.0);
      }
    }
  }
  // Slices of 1 mm are steps of half a millimetre on a ball of 17 mm: 3 % of its volume lie that near to its surface.
  EXPECT_GT(both / sum, 0.97);
}

INSTANTIATE_TEST_SUITE_P(Formats, WrittenDicomLabels, testing::Values("map.dcm", "map.seg.dcm", "map.rtstruct.dcm"));

// Elements of a CT that tell of a patient, and the UIDs that a viewer needs. Slices come in another order than places.
class DicomSources : public testing::Test {
 protected:
  DicomSources() {
    for (int k = 0; k < 4; ++k) {
      HandMadeDicom slice;
      slice.set(0x00080018, "UI", "1.2.826.7." + std::to_string(k))
          .set(0x00080020, "DA", "19991231")
          .set(0x00080050, "SH", "ACC4711")
          .set(0x00080080, "LO", "Hospital of Nowhere")
          .set(0x00080090, "PN", "Referrer^Some")
          .set(0x00100010, "PN", "Patient^Secret")
          .set(0x00100020, "LO", "ID4712")
          .set(0x00100030, "DA", "19501224")
          .set(0x0020000d, "UI", "1.2.826.5")
          .set(0x00200052, "UI", "1.2.826.6")
          .set(0x00281054, "LO", "HU")
          .set_z(2.0 * k);
      write_whole_file(folder_.path() / ("slice" + std::to_string(3 - k) + ".dcm"), slice.bytes());
    }
    ct_ = read_ct(folder_.path());
    labels_ = {ct_.geometry, std::vector<std::uint8_t>(ct_.hu.size(), 0), {{22, {"L3", Level{22}}}}};
    for (std::size_t v = 0; v < 36; v += 2) labels_.labels[v] = 22;  // the first three slices
  }

  TemporaryFolder folder_;
  CtVolume ct_;
  LabelVolume labels_;
};

TEST_F(DicomSources, AreTheImagesThatLieWhereTheSlicesDo) {
  const DicomSource source = find_dicom_source(folder_.path(), "", 0, ct_.geometry);
  EXPECT_EQ(source.study_uid, "1.2.826.5");
  EXPECT_EQ(source.series_uid, "1.2.3");
  EXPECT_EQ(source.frame_of_reference_uid, "1.2.826.6");
  ASSERT_EQ(source.slices.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(source.slices[k]->sop_instance, "1.2.826.7." + std::to_string(k));
  GridGeometry cropped = ct_.geometry;
  cropped.size[2] = 2;
  cropped.origin_mm = cropped.to_patient(Vec3(1.0, 1.0, 2.0));
  EXPECT_EQ(find_dicom_source(folder_.path(), "1.2.3", 0, cropped).slices[1]->sop_instance, "1.2.826.7.3");
  GridGeometry between = ct_.geometry;
  between.origin_mm.z() += 1.0;
  EXPECT_FALSE(find_dicom_source(folder_.path(), "", 0, between).slices[0].has_value());
  EXPECT_TRUE(find_dicom_source(folder_.path(), "1.2.4", 0, ct_.geometry).study_uid.empty());
}

// Two stacks of one series lie at the same places.
TEST_F(DicomSources, AreThoseOfTheStackThatWasRead) {
  for (int k = 0; k < 4; ++k) {
    HandMadeDicom slice;
    slice.set(0x00080018, "UI", "1.2.826.8." + std::to_string(k))
        .set(0x0020000d, "UI", "1.2.826.5")
        .set(0x00200052, "UI", "1.2.826.9")
        .set(0x00281054, "LO", "HU")
        .set_z(2.0 * k);
    write_whole_file(folder_.path() / ("other" + std::to_string(k) + ".dcm"), slice.bytes());
  }
  for (int stack = 1; stack <= 2; ++stack) {
    const CtVolume ct = read_ct(folder_.path(), {.stack = stack});
    const DicomSource source = find_dicom_source(folder_.path(), "", stack, ct.geometry);
    const bool is_first = ct.frame_hash == ct_.frame_hash;
    EXPECT_EQ(source.frame_of_reference_uid, is_first ? "1.2.826.6" : "1.2.826.9");
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(source.slices[k]->sop_instance, (is_first ? "1.2.826.7." : "1.2.826.8.") + std::to_string(k));
    }
  }
}

TEST_F(DicomSources, AreNamedAndNothingElseOfThem) {
  const DicomSource source = find_dicom_source(folder_.path(), "", 0, ct_.geometry);
  for (const char* name : {"map.dcm", "map.rtstruct.dcm"}) {
    const std::string bytes = encode_label_volume(labels_, name, source);
    for (const char* uid : {"1.2.826.5", "1.2.826.6", "1.2.826.7.0", "1.2.826.7.2"}) EXPECT_THAT(bytes, HasSubstr(uid));
    for (const char* secret : {"Secret", "ID4712", "19501224", "19991231", "ACC4711", "Nowhere", "Referrer"}) {
      EXPECT_THAT(bytes, Not(HasSubstr(secret)));
    }
    const std::string alone = encode_label_volume(labels_, name);
    EXPECT_THAT(alone, Not(HasSubstr("1.2.826.")));
  }
}

TEST_F(DicomSources, OfManyFramesAreFrames) {
  test::SeriesRecipe recipe;
  recipe.is_enhanced = true;
  const TemporaryFolder folder;
  const test::MadeSeries series = test::make_series(recipe);
  series.write(folder.path());
  const DicomSource source = find_dicom_source(folder.path(), "", 0, series.ground_truth.geometry);
  for (std::size_t k = 0; k < source.slices.size(); ++k) {
    ASSERT_TRUE(source.slices[k].has_value());
    EXPECT_GT(source.slices[k]->frame, 0);
  }
  EXPECT_NE(source.slices[0]->frame, source.slices[1]->frame);
}

TEST_F(DicomSources, DoNotMakeACtOfALabelMap) {
  write_whole_file(folder_.path() / "labels.seg.dcm", encode_label_volume(labels_, "labels.seg.dcm"));
  EXPECT_THAT(test::error_of([&] { read_ct(folder_.path() / "labels.seg.dcm"); }), HasSubstr("which is a label map"));
  // Beside its CT it is no CT's series.
  EXPECT_EQ(read_ct(folder_.path()).source_hash, ct_.source_hash);
}

TEST(EncodeLabelVolume, RejectsNamesThatDicomCannotHold) {
  LabelVolume volume = patchy_volume();
  volume.names.at(50).name = "left\\right";
  EXPECT_THAT(test::error_of([&] { encode_label_volume(volume, "map.dcm"); }), HasSubstr("without backslash"));
  volume.labels.assign(volume.labels.size(), 0);
  volume.names.clear();
  EXPECT_THAT(test::error_of([&] { encode_label_volume(volume, "map.dcm"); }), HasSubstr("found none"));
  EXPECT_THAT(test::error_of([&] { encode_label_volume(volume, "map.rtstruct.dcm"); }), HasSubstr("found none"));
}

}  // namespace
}  // namespace spinaltap
