#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nifti2_io.h>

#include <algorithm>
#include <memory>

#include "core/ct/dicom_read.h"
#include "core/ct/read_ct.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_data.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(ReadRealDicom, AgreesWithTheNiftiOfTheL3Vertebra) {
  SPINALTAP_NEED_TEST_DATA(data, "L3_ct_1.5mm");
  const CtVolume ct = read_dicom(data / "dicom");
  EXPECT_THAT(ct.geometry.size, ElementsAre(73, 73, 47));
  EXPECT_EQ(ct.geometry.spacing_mm, Vec3(1.5, 1.5, 1.5));

  nifti_set_debug_level(0);
  const std::unique_ptr<nifti_image, void (*)(nifti_image*)> nifti(
      nifti_image_read((data / "sub-ct_label-22_ct.nii.gz").c_str(), 1), nifti_image_free);
  ASSERT_TRUE(nifti);
  ASSERT_EQ(nifti->datatype, NIFTI_TYPE_INT16);
  ASSERT_EQ(static_cast<std::size_t>(nifti->nvox), ct.hu.size());
  const auto* values = static_cast<const std::int16_t*>(nifti->data);
  const nifti_dmat44& ras = nifti->sform_code > 0 ? nifti->sto_xyz : nifti->qto_xyz;
  std::size_t n = 0;
  std::size_t different = 0;
  for (int k = 0; k < nifti->nz; ++k) {
    for (int j = 0; j < nifti->ny; ++j) {
      for (int i = 0; i < nifti->nx; ++i, ++n) {
        const auto row = [&](int r) { return ras.m[r][0] * i + ras.m[r][1] * j + ras.m[r][2] * k + ras.m[r][3]; };
        const Vec3 p_index = ct.geometry.to_index(Vec3(-row(0), -row(1), row(2)));
        const Vec3 nearest = p_index.array().round();
        ASSERT_LT((p_index - nearest).norm(), 1e-3);  // both grids have the same voxel centres
        const auto at = [&](int axis) { return static_cast<int>(nearest[axis]); };
        ASSERT_TRUE(ct.geometry.contains(at(0), at(1), at(2)));
        if (ct.at(at(0), at(1), at(2)) != values[n]) ++different;
      }
    }
  }
  EXPECT_EQ(different, 0u);
}

TEST(ReadRealDicom, AgreesWithOurOwnReadingOfTheNiftiVoxelForVoxel) {
  SPINALTAP_NEED_TEST_DATA(data, "L3_ct_1.5mm");
  const CtVolume dicom = read_ct(data / "dicom");
  const CtVolume nifti = read_ct(data / "sub-ct_label-22_ct.nii.gz");
  EXPECT_EQ(nifti.hu, dicom.hu);
  EXPECT_EQ(nifti.geometry.size, dicom.geometry.size);
  EXPECT_EQ(nifti.geometry.directions, dicom.geometry.directions);
  EXPECT_LT((nifti.geometry.origin_mm - dicom.geometry.origin_mm).norm(), 1e-4);  // floats in the NIfTI
  EXPECT_LT((nifti.geometry.spacing_mm - dicom.geometry.spacing_mm).norm(), 1e-6);
  // Read out of the NIfTI by hand.
  EXPECT_NEAR(sample_hu(nifti, Vec3(33.0, 192.0, -67.2)), 404.0, 0.1);
  EXPECT_NEAR(sample_hu(dicom, Vec3(33.0, 192.0, -67.2)), 404.0, 0.1);
  EXPECT_NEAR(sample_hu(dicom, Vec3(24.0, 189.0, -68.7)), -15.0, 0.1);
}

TEST(ReadRealDicom, ReadsTheT11SeriesWhoseNamesAreNotInOrder) {
  SPINALTAP_NEED_TEST_DATA(data, "T11_ct_0.78mm");
  const CtVolume ct = read_dicom(data);
  EXPECT_THAT(ct.geometry.size, ElementsAre(512, 512, 70));
  EXPECT_EQ(ct.geometry.spacing_mm, Vec3(0.78125, 0.78125, 1.0));
  EXPECT_NEAR(ct.geometry.origin_mm.z(), -679.8, 1e-3);
  EXPECT_NEAR(ct.geometry.to_patient(Vec3(0.0, 0.0, 69.0)).z(), -610.8, 1e-3);
  EXPECT_EQ(*std::min_element(ct.hu.begin(), ct.hu.end()), -1000);
  EXPECT_EQ(*std::max_element(ct.hu.begin(), ct.hu.end()), 1755);
  // Read out of the files' bytes by hand, at positions that their headers state.
  EXPECT_EQ(ct.at(256, 320, 29), 33);  // z -650.8
  EXPECT_EQ(ct.at(100, 100, 29), -988);
  EXPECT_EQ(ct.at(300, 200, 29), 96);
  EXPECT_EQ(ct.at(250, 330, 0), 131);
  EXPECT_EQ(ct.at(256, 320, 69), 82);
  EXPECT_NEAR(sample_hu(ct, Vec3(33.375, 97.25, -650.8)), 96.0, 0.1);
}

TEST(ReadRealDicom, ReadsAJpeg2000SeriesWithoutUids) {
  SPINALTAP_NEED_TEST_DATA(data, "thoracic_ct_j2k");
  const CtVolume ct = read_dicom(data);
  EXPECT_THAT(ct.geometry.size, ElementsAre(512, 512, 20));
  EXPECT_NEAR(ct.geometry.spacing_mm.x(), 0.977, 1e-3);
  EXPECT_EQ(ct.geometry.spacing_mm.z(), 2.0);  // SliceThickness says 3
  EXPECT_NEAR(ct.geometry.origin_mm.z(), -804.5, 1e-3);
  EXPECT_EQ(*std::min_element(ct.hu.begin(), ct.hu.end()), -1024);
  EXPECT_EQ(*std::max_element(ct.hu.begin(), ct.hu.end()), 1839);
  // LargestImagePixelValue of the files, from the lowest slice upwards.
  const std::vector<int> largest{2429, 2420, 2414, 2431, 2458, 2472, 2480, 2467, 2458, 2468,
                                 2469, 2474, 2473, 2496, 2496, 2863, 2757, 2467, 2454, 2460};
  for (int k = 0; k < 20; ++k) {
    const auto slice = ct.hu.begin() + static_cast<std::ptrdiff_t>(ct.geometry.offset(0, 0, k));
    EXPECT_EQ(*std::max_element(slice, slice + 512 * 512), largest[static_cast<std::size_t>(k)] - 1024) << k;
  }
}

TEST(ReadRealDicom, NamesACompressedFileCutShort) {
  SPINALTAP_NEED_TEST_DATA(data, "thoracic_ct_j2k");
  const TemporaryFolder folder;
  fs::copy(data / "dicom", folder.path(), fs::copy_options::recursive);
  const fs::path cut = fs::directory_iterator(folder.path())->path();
  fs::resize_file(cut, fs::file_size(cut) / 2);
  EXPECT_THAT(error_of([&] { read_dicom(folder.path()); }), HasSubstr(cut.filename().string()));
}

}  // namespace
}  // namespace spinaltap
