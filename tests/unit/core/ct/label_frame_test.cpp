// DICOM label maps beside CTs of their own and of another frame of reference.

#include "core/ct/label_frame.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/staged_output.h"
#include "core/ct/crop.h"
#include "core/ct/dicom_read.h"
#include "core/ct/dicom_source.h"
#include "core/ct/dicom_write.h"
#include "core/ct/label_volume.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

class LabelFrame : public testing::TestWithParam<std::string> {
 protected:
  static CtVolume written_ct(const std::filesystem::path& folder, std::int16_t hu) {
    GridGeometry geometry;
    geometry.size = {8, 7, 6};
    geometry.spacing_mm = Vec3(1.0, 1.0, 1.5);
    std::filesystem::create_directory(folder);
    write_dicom(make_ct_volume(geometry, std::vector<std::int16_t>(geometry.voxel_count(), hu)), folder);
    return read_dicom(folder);
  }

  /// As from a program that labelled the CT in `ct_folder`.
  static std::filesystem::path labels_of(const CtVolume& ct, const std::filesystem::path& ct_folder,
                                         const std::filesystem::path& file) {
    LabelVolume labels{ct.geometry, std::vector<std::uint8_t>(ct.hu.size(), 0), {{22, {"L3", Level{22}}}}};
    labels.labels[ct.geometry.offset(3, 3, 3)] = 22;
    write_whole_file(file, encode_label_volume(labels, file, find_dicom_source(ct_folder, "", 0, ct.geometry)));
    return file;
  }

  const test::TemporaryFolder folder_;
};

TEST_P(LabelFrame, OfAnotherCtIsWarnedOfAndItsOwnIsNot) {
  const CtVolume ct = written_ct(folder_.path() / "ct", 40);
  const CtVolume other = written_ct(folder_.path() / "other", 60);
  ASSERT_NE(ct.frame_hash, other.frame_hash);
  const std::filesystem::path labels = labels_of(ct, folder_.path() / "ct", folder_.path() / GetParam());
  EXPECT_EQ(warning_of_frame(labels, ct), std::nullopt);
  EXPECT_EQ(warning_of_frame(labels, crop(ct, {{1, 1, 1}, {5, 5, 4}})), std::nullopt);
  EXPECT_THAT(warning_of_frame(labels, other).value_or(""), testing::HasSubstr("FrameOfReferenceUID"));
  CtVolume unnamed = other;
  unnamed.frame_hash.clear();
  EXPECT_EQ(warning_of_frame(labels, unnamed), std::nullopt);
}

INSTANTIATE_TEST_SUITE_P(Kinds, LabelFrame, testing::Values("map.dcm", "map.rtstruct.dcm"));

TEST(LabelFrameAlone, IsNothingThatOtherFormatsName) {
  const test::TemporaryFolder folder;
  LabelVolume labels;
  labels.geometry.size = {3, 3, 3};
  labels.labels.assign(27, 22);
  labels.names = {{22, {"L3", Level{22}}}};
  CtVolume ct;
  ct.frame_hash = hash_of_frame("1.2.3");
  for (const char* name : {"map.nii.gz", "map.seg.nrrd"}) {
    write_whole_file(folder.path() / name, encode_label_volume(labels, name));
    EXPECT_EQ(warning_of_frame(folder.path() / name, ct), std::nullopt) << name;
  }
}

}  // namespace
}  // namespace spinaltap
