#include "core/ct/label_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "core/base/staged_output.h"
#include "core/ct/dicom_read.h"
#include "tests/support/error_of.h"
#include "tests/support/mask_overlap.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_data.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::TemporaryFolder;
using test::voxel_count;
using testing::AllOf;
using testing::HasSubstr;

enum class Type : std::int16_t { kUint8 = 2, kInt16 = 4, kFloat = 16 };

/// A NIfTI-1 file put together byte by byte: 3 x 2 x 2 voxels, 1 mm, voxel (0, 0, 0) at RAS (10, 20, 30).
struct HandMadeNifti {
  Type type = Type::kInt16;
  std::vector<double> values = {0, 0, 5, 0, 0, 0, 7, 0, 0, 0, 0, 0};
  std::vector<int> dim = {3, 3, 2, 2, 1, 1, 1, 1};
  float slope = 0.0F;
  float intercept = 0.0F;
  int sform_code = 1;
  int qform_code = 0;

  std::string bytes() const {
    std::string header(352, '\0');
    const auto put = [&](std::size_t offset, auto value) { std::memcpy(header.data() + offset, &value, sizeof value); };
    put(0, std::int32_t{348});
    for (std::size_t n = 0; n < 8; ++n) put(40 + 2 * n, static_cast<std::int16_t>(dim[n]));
    put(70, static_cast<std::int16_t>(type));
    put(72, static_cast<std::int16_t>(type == Type::kUint8 ? 8 : type == Type::kInt16 ? 16 : 32));
    for (std::size_t n = 0; n < 4; ++n) put(76 + 4 * n, 1.0F);
    put(108, 352.0F);
    put(112, slope);
    put(116, intercept);
    put(252, static_cast<std::int16_t>(qform_code));
    put(254, static_cast<std::int16_t>(sform_code));
    // Quaternion (0, 0, 0): no rotation; the same place as the sform.
    put(268, 10.0F), put(272, 20.0F), put(276, 30.0F);
    const float rows[3][4] = {{1, 0, 0, 10}, {0, 1, 0, 20}, {0, 0, 1, 30}};
    std::memcpy(header.data() + 280, rows, sizeof rows);
    std::memcpy(header.data() + 344, "n+1", 4);
    for (const double value : values) {
      const auto append = [&](auto stored) {
        char raw[sizeof stored];
        std::memcpy(raw, &stored, sizeof stored);
        header.append(raw, sizeof stored);
      };
      if (type == Type::kUint8) append(static_cast<std::uint8_t>(value));
      if (type == Type::kInt16) append(static_cast<std::int16_t>(value));
      if (type == Type::kFloat) append(static_cast<float>(value));
    }
    return header;
  }
};

/// LPS grid with a voxel on each of the file's: x and y run backwards, from RAS (12, 21).
GridGeometry nifti_grid() {
  GridGeometry geometry;
  geometry.size = {3, 2, 2};
  geometry.origin_mm = Vec3(-12.0, -21.0, 30.0);
  return geometry;
}

BoneMask read_nifti(const HandMadeNifti& nifti, int label, const GridGeometry& geometry = nifti_grid()) {
  const TemporaryFolder folder;
  write_whole_file(folder.path() / "labels.nii", nifti.bytes());
  return read_label_map(folder.path() / "labels.nii", label, geometry);
}

std::string nifti_error(const HandMadeNifti& nifti, int label = 5) {
  return error_of([&] { read_nifti(nifti, label); });
}

TEST(ReadLabelMap, TurnsRasIntoLps) {
  const BoneMask mask = read_nifti({}, 5);  // file voxel (2, 0, 0): RAS (12, 20, 30), LPS (-12, -20, 30)
  EXPECT_EQ(voxel_count(mask), 1);
  EXPECT_TRUE(mask.at(0, 1, 0));
  EXPECT_TRUE(read_nifti({}, 7).at(2, 1, 1));  // file voxel (0, 0, 1)
}

TEST(ReadLabelMap, ReadsEachTypeOfNumber) {
  for (const Type type : {Type::kUint8, Type::kInt16, Type::kFloat}) {
    EXPECT_TRUE(read_nifti({.type = type}, 5).at(0, 1, 0)) << static_cast<int>(type);
  }
}

// A map of probabilities has no labels; 5 is no 5.4 that was rounded.
TEST(ReadLabelMap, RejectsFractions) {
  HandMadeNifti nifti{.type = Type::kFloat};
  nifti.values[2] = 5.0004;  // of a map that was stored as floats
  EXPECT_TRUE(read_nifti(nifti, 5).at(0, 1, 0));
  nifti.values[6] = 5.4;
  EXPECT_THAT(nifti_error(nifti), HasSubstr("whole numbers, found 5.4"));
}

TEST(ReadLabelMap, AppliesTheSlope) {
  EXPECT_TRUE(read_nifti({.slope = 2.0F, .intercept = 1.0F}, 11).at(0, 1, 0));  // 2 * 5 + 1
}

TEST(ReadLabelMap, UsesTheQformWithoutASform) {
  EXPECT_TRUE(read_nifti({.sform_code = 0, .qform_code = 1}, 5).at(0, 1, 0));
  EXPECT_THAT(nifti_error({.sform_code = 0}), HasSubstr("sform or qform"));
}

TEST(EncodeLabelMap, WritesAQformThatSaysTheSamePlaceAsTheSform) {
  for (const bool is_mirrored : {false, true}) {
    for (const double angle_rad : {0.0, 0.3, 1.9, 3.1415}) {
      BoneMask mask;
      mask.geometry.size = {7, 5, 4};
      mask.geometry.spacing_mm = Vec3(0.7, 0.9, 1.25);
      mask.geometry.origin_mm = Vec3(-101.25, 33.7, -679.8);
      mask.geometry.directions = Eigen::AngleAxisd(angle_rad, Vec3(1, -2, 2).normalized()).toRotationMatrix();
      if (is_mirrored) mask.geometry.directions.col(2) *= -1.0;
      mask.inside.assign(mask.geometry.voxel_count(), 0);
      mask.inside[mask.geometry.offset(6, 1, 2)] = mask.inside[mask.geometry.offset(0, 4, 3)] = 1;
      const TemporaryFolder folder;
      const auto file = folder.path() / "mask.nii.gz";
      write_whole_file(file, encode_label_map(mask, 3, file));
      for (const NiftiAffine affine : {NiftiAffine::automatic, NiftiAffine::sform, NiftiAffine::qform}) {
        std::vector<std::string> warnings;
        EXPECT_EQ(read_label_map(file, 3, mask.geometry, affine, &warnings).inside, mask.inside) << angle_rad;
        EXPECT_TRUE(warnings.empty()) << warnings.front();
      }
    }
  }
}

TEST(ReadLabelMap, TakesTheNearestVoxelOnAFinerGrid) {
  GridGeometry fine = nifti_grid();
  fine.size = {12, 8, 8};
  fine.spacing_mm = Vec3::Constant(0.25);
  fine.origin_mm = Vec3(-12.375, -21.375, 29.625);  // four fine voxels fill each of the file's, along each axis
  EXPECT_EQ(voxel_count(read_nifti({}, 5, fine)), 64);
}

TEST(ReadLabelMap, ListsTheLabelsThatThereAre) {
  EXPECT_THAT(nifti_error({}, 6), AllOf(HasSubstr("no label 6"), HasSubstr("there are: 5, 7")));
  EXPECT_THAT(nifti_error({.values = std::vector<double>(12)}, 6), HasSubstr("there are: none"));
}

TEST(ReadLabelMap, SaysWhenTheLabelLiesOutsideTheCt) {
  GridGeometry far = nifti_grid();
  far.origin_mm.x() += 100.0;
  EXPECT_THAT(error_of([&] { read_nifti({}, 5, far); }), HasSubstr("within the CT"));
}

TEST(ReadLabelMap, RejectsAbsurdSizesBeforeItTakesMemory) {
  EXPECT_THAT(nifti_error({.dim = {3, 30000, 30000, 30000, 1, 1, 1, 1}}), HasSubstr("at most"));
  EXPECT_THAT(nifti_error({.dim = {3, 1000, 1000, 1000, 1, 1, 1, 1}}), HasSubstr("cut short"));
  EXPECT_THAT(nifti_error({.dim = {4, 3, 2, 1, 2, 1, 1, 1}}), HasSubstr("expected one volume"));
}

TEST(ReadLabelMap, TakesFourDimensionsWithOneVolume) {
  EXPECT_TRUE(read_nifti({.dim = {4, 3, 2, 2, 1, 1, 1, 1}}, 5).at(0, 1, 0));
}

TEST(ReadLabelMap, NamesFilesThatAreNotNifti) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "labels.nii";
  EXPECT_THAT(error_of([&] { read_label_map(file, 5, nifti_grid()); }), HasSubstr("no such file"));
  EXPECT_THAT(error_of([&] { read_label_map(folder.path(), 5, nifti_grid()); }), HasSubstr("something else"));
  write_whole_file(file, "not NIfTI at all");
  EXPECT_THAT(error_of([&] { read_label_map(file, 5, nifti_grid()); }), HasSubstr("labels.nii"));
  write_whole_file(file, HandMadeNifti{}.bytes().substr(0, 360));
  EXPECT_THAT(error_of([&] { read_label_map(file, 5, nifti_grid()); }), HasSubstr("cut short"));
}

TEST(ReadLabelMap, FindsTheWholeL3) {
  SPINALTAP_NEED_TEST_DATA(data, "L3_ct_1.5mm");
  const CtVolume ct = read_dicom(data / "dicom");
  const fs::path labels = data / "sub-ct_seg-vert_label-22_msk.nii.gz";
  const BoneMask mask = read_label_map(labels, 22, ct.geometry);
  EXPECT_EQ(voxel_count(mask), 17698);
  // Bone is where the CT is bright: the mean of L3 lies far above that of soft tissue (about 50 HU).
  double sum_hu = 0.0;
  for (std::size_t n = 0; n < mask.inside.size(); ++n) sum_hu += mask.inside[n] * ct.hu[n];
  EXPECT_GT(sum_hu / 17698.0, 150.0);
  EXPECT_THAT(error_of([&] { read_label_map(labels, 1, ct.geometry); }), HasSubstr("21, 22, 23"));
}

}  // namespace
}  // namespace spinaltap
