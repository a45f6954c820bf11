#include "core/ct/detail/nifti_read.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/staged_output.h"
#include "core/ct/read_ct.h"
#include "tests/support/error_of.h"
#include "tests/support/made_nifti.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::MadeNifti;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

/// 4 x 3 x 2 voxels whose values are 100 i + 10 j + k.
MadeNifti numbered_nifti() {
  MadeNifti nifti;
  for (int k = 0; k < 2; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 4; ++i) nifti.values.push_back(100 * i + 10 * j + k);
    }
  }
  return nifti;
}

CtVolume read_made(const MadeNifti& nifti, bool zipped = false) {
  const TemporaryFolder folder;
  const auto file = folder.path() / (zipped ? "ct.nii.gz" : "ct.nii");
  write_whole_file(file, zipped ? test::gzipped(nifti.bytes()) : nifti.bytes());
  return read_ct(file);
}

TEST(ReadNiftiCt, TurnsRasIntoLpsWithAxesInTheOrderOfThePatients) {
  MadeNifti nifti = numbered_nifti();
  nifti.ras_steps = Vec3(0.5, 0.75, 2.0).asDiagonal();
  nifti.ras_origin_mm = Vec3(10.0, 20.0, 30.0);
  const CtVolume ct = read_made(nifti);
  EXPECT_THAT(ct.geometry.size, ElementsAre(4, 3, 2));
  EXPECT_TRUE(ct.geometry.directions.isApprox(Mat3::Identity()));
  EXPECT_EQ(ct.geometry.spacing_mm, Vec3(0.5, 0.75, 2.0));
  // The file's voxel (3, 2, 0) is the one farthest to the right and to the front: the first in LPS.
  EXPECT_EQ(ct.geometry.origin_mm, Vec3(-11.5, -21.5, 30.0));
  EXPECT_EQ(ct.at(0, 0, 0), 320);
  EXPECT_EQ(ct.at(3, 2, 1), 1);
}

TEST(ReadNiftiCt, PlacesEveryVoxelOfAnyOrientation) {
  MadeNifti nifti = numbered_nifti();
  const Mat3 turn = Eigen::AngleAxisd(0.5, Vec3(1, -2, 1).normalized()).toRotationMatrix();
  for (const bool mirrored : {false, true}) {
    Mat3 axes;  // as sagittal scanners store them, then turned a little; and mirrored
    axes << 0, 0, (mirrored ? 1 : -1), 1, 0, 0, 0, -1, 0;
    nifti.ras_steps = turn * axes * Vec3(0.5, 0.75, 2.0).asDiagonal();
    const CtVolume ct = read_made(nifti);
    EXPECT_GT(ct.geometry.directions.determinant(), 0.0);
    EXPECT_GT(ct.geometry.directions.diagonal().minCoeff(), 0.5);
    for (int k = 0; k < 2; ++k) {
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 4; ++i) {
          const Vec3 ras = nifti.ras_steps * Vec3(i, j, k);
          const Vec3 p_index = ct.geometry.to_index(Vec3(-ras.x(), -ras.y(), ras.z()));
          const Vec3 nearest = p_index.array().round();
          ASSERT_LT((p_index - nearest).norm(), 1e-5);  // the file's numbers are floats
          const auto at = [&](int axis) { return static_cast<int>(nearest[axis]); };
          ASSERT_TRUE(ct.geometry.contains(at(0), at(1), at(2)));
          EXPECT_EQ(ct.at(at(0), at(1), at(2)), 100 * i + 10 * j + k);
        }
      }
    }
  }
}

TEST(ReadNiftiCt, ReadsBothVersionsByteOrdersAndZippedAlike) {
  const std::string expected = read_made(numbered_nifti()).source_hash;
  for (const bool is_second : {false, true}) {
    for (const bool is_big_endian : {false, true}) {
      for (const auto type : {MadeNifti::Type::kInt16, MadeNifti::Type::kFloat, MadeNifti::Type::kDouble}) {
        MadeNifti nifti = numbered_nifti();
        nifti.is_second = is_second;
        nifti.is_big_endian = is_big_endian;
        nifti.type = type;
        EXPECT_EQ(read_made(nifti).source_hash, expected);
        EXPECT_EQ(read_made(nifti, true).source_hash, expected);
        nifti.values_at = 1000.0;  // behind extensions
        EXPECT_EQ(read_made(nifti).source_hash, expected);
      }
    }
  }
}

// As programs and disks of old write names.
TEST(ReadNiftiCt, TakesNamesInCapitals) {
  const test::TemporaryFolder folder;
  const std::string bytes = numbered_nifti().bytes();
  for (const char* name : {"CT.NII", "ct.nii"}) write_whole_file(folder.path() / name, bytes);
  for (const char* name : {"CT.NII.GZ", "ct.nii.gz"}) write_whole_file(folder.path() / name, test::gzipped(bytes));
  const std::string plain = read_ct(folder.path() / "ct.nii").source_hash;
  for (const char* name : {"CT.NII", "CT.NII.GZ", "ct.nii.gz"}) {
    EXPECT_EQ(read_ct(folder.path() / name).source_hash, plain) << name;
  }
  write_whole_file(folder.path() / "ct.Nii", bytes);
  EXPECT_THAT(test::error_of([&] { read_ct(folder.path() / "ct.Nii"); }), HasSubstr("small letters or in capitals"));
}

TEST(ReadNiftiCt, ScalesRoundsClampsAndMakesAirOfWhatIsNoNumber) {
  MadeNifti nifti = numbered_nifti();
  nifti.type = MadeNifti::Type::kFloat;
  nifti.slope = 2.0;
  nifti.intercept = -1024.0;
  nifti.values.assign(24, 0.0);
  nifti.values[0] = 500.3;  // the last voxel in LPS of the first slice
  nifti.values[1] = 1e9;
  nifti.values[2] = std::numeric_limits<double>::quiet_NaN();
  nifti.values[3] = -std::numeric_limits<double>::infinity();
  const CtVolume ct = read_made(nifti);
  EXPECT_EQ(ct.at(3, 2, 0), -23);  // -23.4
  EXPECT_EQ(ct.at(2, 2, 0), 32767);
  EXPECT_EQ(ct.at(1, 2, 0), -1024);
  EXPECT_EQ(ct.at(0, 2, 0), -32768);
  EXPECT_EQ(ct.at(0, 0, 1), -1024);
}

TEST(ReadNiftiCt, ResamplesAStackThatLeans) {
  MadeNifti nifti;
  nifti.dim = {3, 20, 20, 6, 1, 1, 1, 1};
  nifti.ras_steps.col(2) = Vec3(0.0, 0.5, 2.0);  // 14 degrees
  for (int k = 0; k < 6; ++k) {
    for (int j = 0; j < 20; ++j) {
      for (int i = 0; i < 20; ++i) nifti.values.push_back(10 * i + 20 * (j + 0.5 * k) + 30 * k);
    }
  }
  const CtVolume ct = read_made(nifti);
  EXPECT_TRUE(ct.geometry.directions.isApprox(Mat3::Identity()));
  EXPECT_EQ(ct.geometry.spacing_mm, Vec3(1.0, 1.0, 2.0));
  EXPECT_THAT(ct.geometry.size, ElementsAre(20, 23, 6));
  for (int k = 0; k < 6; ++k) {
    for (int y = 5; y < 18; ++y) {  // RAS mm; linear fields come back but for rounding
      const Vec3 p_index = ct.geometry.to_index(Vec3(-7.0, -y, 2.0 * k));
      EXPECT_NEAR(ct.at(static_cast<int>(std::lround(p_index.x())), static_cast<int>(std::lround(p_index.y())), k),
                  70 + 20 * y + 30 * k, 1.0);
    }
  }
}

TEST(ReadNiftiCt, TakesTheScannersPlaceBesideOneInATemplate) {
  for (const bool is_second : {false, true}) {
    MadeNifti nifti = numbered_nifti();
    nifti.is_second = is_second;
    nifti.ras_steps = 1.65 * Mat3::Identity();
    nifti.sform_code = 4;
    nifti.qform_code = 1;
    nifti.pixdim = Vec3::Constant(1.5);
    const TemporaryFolder folder;
    write_whole_file(folder.path() / "ct.nii", nifti.bytes());
    const CtVolume ct = read_ct(folder.path() / "ct.nii");
    EXPECT_EQ(ct.geometry.spacing_mm, Vec3::Constant(1.5));
    ASSERT_EQ(ct.warnings.size(), 1U);
    EXPECT_THAT(ct.warnings.front(), HasSubstr("the MNI 152 template"));
    const CtVolume by_sform = read_ct(folder.path() / "ct.nii", {.affine = NiftiAffine::sform});
    EXPECT_NEAR(by_sform.geometry.spacing_mm.x(), 1.65, 1e-6);
    EXPECT_TRUE(by_sform.warnings.empty());
    EXPECT_EQ(by_sform.choices.at("nifti_affine"), "sform, as was said");
  }
}

TEST(ReadNiftiCt, ReadsLengthsInTheHeadersUnit) {
  MadeNifti nifti = numbered_nifti();
  nifti.ras_steps = 1500.0 * Mat3::Identity();
  nifti.unit = 3;
  EXPECT_EQ(read_made(nifti).geometry.spacing_mm, Vec3::Constant(1.5));
  nifti.unit = 2;
  EXPECT_THAT(test::error_of([&] { read_made(nifti); }), HasSubstr("xyzt_units"));
}

// As other raw voxels: what is longer has another header's sizes.
TEST(ReadNiftiCt, RejectsMoreVoxelsThanTheHeaderSays) {
  for (const bool zipped : {false, true}) {
    MadeNifti nifti = numbered_nifti();
    nifti.dim[1] = 3;
    EXPECT_THAT(test::error_of([&] { read_made(nifti, zipped); }),
                HasSubstr("expected 36 bytes of voxels, found more"));
    // Axes that are not counted may not have voxels either.
    nifti = numbered_nifti();
    nifti.dim = {3, 4, 3, 2, 2, 1, 1, 1};
    nifti.values.insert(nifti.values.end(), 24, 0.0);
    EXPECT_THAT(test::error_of([&] { read_made(nifti, zipped); }), HasSubstr("found more"));
  }
}

TEST(ReadNiftiCt, RejectsASeriesForAFileThatHoldsNone) {
  const TemporaryFolder folder;
  write_whole_file(folder.path() / "ct.nii", numbered_nifti().bytes());
  EXPECT_THAT(test::error_of([&] { read_ct(folder.path() / "ct.nii", {.series = "1"}); }), HasSubstr("no series"));
}

}  // namespace
}  // namespace spinaltap
