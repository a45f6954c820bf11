#include "core/ct/dicom_write.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/random.h"
#include "core/base/staged_output.h"
#include "core/ct/detail/dicom_uid.h"
#include "core/ct/dicom_read.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

/// Every voxel different from its neighbours, over the whole range of 16 bits.
CtVolume noisy_ct(const GridGeometry& geometry) {
  std::vector<std::int16_t> hu(geometry.voxel_count());
  for (std::size_t n = 0; n < hu.size(); ++n) {
    hu[n] = static_cast<std::int16_t>(65536.0 * random_uniform(1, n) - 32768.0);
  }
  hu[0] = std::numeric_limits<std::int16_t>::min();
  hu[1] = std::numeric_limits<std::int16_t>::max();
  return make_ct_volume(geometry, std::move(hu));
}

GridGeometry straight_grid() {
  GridGeometry geometry;
  geometry.size = {7, 5, 12};
  geometry.origin_mm = Vec3(-30.1, 135.0, -103.2);
  geometry.spacing_mm = Vec3(0.3, 0.7, 0.625);
  return geometry;
}

GridGeometry oblique_grid() {
  GridGeometry geometry = straight_grid();
  geometry.directions = (Eigen::AngleAxisd(0.4, Vec3(1.0, 2.0, 3.0).normalized())).toRotationMatrix();
  return geometry;
}

TEST(WriteDicom, ReadsBackAsTheSameStraightVolume) {
  const TemporaryFolder folder;
  const CtVolume ct = noisy_ct(straight_grid());
  write_dicom(ct, folder.path());
  const CtVolume back = read_dicom(folder.path());
  EXPECT_EQ(back.source_hash, ct.source_hash);  // decimals survive: geometry and voxels agree bit for bit
}

TEST(WriteDicom, ReadsBackAnObliqueVolumeWithExactVoxels) {
  const TemporaryFolder folder;
  const CtVolume ct = noisy_ct(oblique_grid());
  write_dicom(ct, folder.path());
  const CtVolume back = read_dicom(folder.path());
  EXPECT_EQ(back.hu, ct.hu);
  EXPECT_NE(back.source_hash, ct.source_hash);  // the last digits of places
  EXPECT_EQ(back.whole_hash, ct.whole_hash);    // but it is the same CT
  EXPECT_EQ(back.geometry.size, ct.geometry.size);
  // 16 characters keep 11 decimals of a position below 1000 mm and 13 of a direction.
  EXPECT_LT((back.geometry.origin_mm - ct.geometry.origin_mm).norm(), 1e-10);
  EXPECT_LT((back.geometry.spacing_mm - ct.geometry.spacing_mm).norm(), 1e-9);
  EXPECT_LT((back.geometry.directions - ct.geometry.directions).norm(), 1e-12);
}

TEST(WriteDicom, KeepsALeftHandedVolumeWhereItIs) {
  const TemporaryFolder folder;
  GridGeometry geometry = oblique_grid();
  geometry.directions.col(2) *= -1.0;
  const CtVolume ct = noisy_ct(geometry);
  write_dicom(ct, folder.path());
  const CtVolume back = read_dicom(folder.path());  // right-handed: the slices come in the opposite order
  const int last = geometry.size[2] - 1;
  EXPECT_EQ(back.at(3, 2, 0), ct.at(3, 2, last));
  EXPECT_LT((back.geometry.origin_mm - geometry.to_patient(Vec3(0.0, 0.0, last))).norm(), 1e-9);
}

TEST(WriteDicom, GivesTheSameBytesEachTime) {
  const TemporaryFolder first;
  const TemporaryFolder second;
  const CtVolume ct = noisy_ct(oblique_grid());
  write_dicom(ct, first.path());
  write_dicom(ct, second.path());
  int files = 0;
  for (const auto& entry : fs::directory_iterator(first.path())) {
    EXPECT_EQ(read_whole_file(entry.path()), read_whole_file(second.path() / entry.path().filename()));
    ++files;
  }
  EXPECT_EQ(files, 12);
}

TEST(WriteDicom, WritesTheAttributesOfACtSlice) {
  const TemporaryFolder folder;
  write_dicom(noisy_ct(straight_grid()), folder.path(), {.series_description = "spine", .slice_thickness_mm = 1.25});
  const std::string bytes = read_whole_file(folder.path() / "0012.dcm");
  EXPECT_THAT(bytes, HasSubstr("SpinalTap^Phantom"));
  EXPECT_THAT(bytes, HasSubstr("PHANTOM"));
  EXPECT_THAT(bytes, HasSubstr("spine "));
  EXPECT_THAT(bytes, HasSubstr(std::string("\x18\0\x50\0DS\x04\0", 8) + "1.25"));    // SliceThickness
  EXPECT_THAT(bytes, HasSubstr(std::string("\x18\0\x88\0DS\x06\0", 8) + "0.625 "));  // SpacingBetweenSlices
  EXPECT_THAT(bytes, HasSubstr(std::string("\x28\0\x30\0DS\x08\0", 8) + "0.7\\0.3 "));
  EXPECT_THAT(bytes, HasSubstr(std::string("\x20\0\x13\0IS\x02\0", 8) + "12"));  // InstanceNumber
}

TEST(WriteDicom, SaysWhenTheStudyWasAndOfWhatPart) {
  const TemporaryFolder folder;
  write_dicom(noisy_ct(straight_grid()), folder.path());
  const std::string bytes = read_whole_file(folder.path() / "0001.dcm");
  EXPECT_THAT(bytes, HasSubstr(std::string("\x08\0\x20\0DA\x08\0", 8) + "20000101"));  // dcmmkdir asks for both
  EXPECT_THAT(bytes, HasSubstr(std::string("\x08\0\x30\0TM\x06\0", 8) + "000000"));
  EXPECT_THAT(bytes,
              HasSubstr(std::string("\x18\0\x15\0CS\x06\0", 8) + "SPINE "));  // else dciodvfy asks for a Laterality
}

/// What a command writes, of both streams, and its exit status; nothing where there is no such program.
std::optional<std::pair<std::string, int>> answer_of(const std::string& program, const std::string& arguments) {
  if (std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) != 0) return std::nullopt;
  FILE* pipe = ::popen((program + " " + arguments + " 2>&1").c_str(), "r");
  std::string text;
  std::array<char, 4096> buffer{};
  for (std::size_t got = 0; (got = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    text.append(buffer.data(), got);
  return std::pair{text, ::pclose(pipe)};
}

TEST(WriteDicom, IsWithoutErrorsInDciodvfy) {
  const TemporaryFolder folder;
  write_dicom(noisy_ct(oblique_grid()), folder.path());
  const auto answer = answer_of("dciodvfy", (folder.path() / "0003.dcm").string());
  if (!answer) GTEST_SKIP() << "dciodvfy is not there: Debian's package dicom3tools has it";
  EXPECT_THAT(answer->first, HasSubstr("CTImage"));
  EXPECT_THAT(answer->first, Not(HasSubstr("Error")));
  EXPECT_THAT(answer->first, Not(HasSubstr("DICOMDIR")));
}

TEST(WriteDicom, IsTakenIntoADicomdirByDcmmkdir) {
  const TemporaryFolder folder;
  write_dicom(noisy_ct(straight_grid()), folder.path());
  // Names of files on a medium are capitals and digits without an ending.
  for (int n = 1; n <= 3; ++n) {
    fs::copy_file(folder.path() / ("000" + std::to_string(n) + ".dcm"), folder.path() / ("IM" + std::to_string(n)));
  }
  const auto answer = answer_of(
      "dcmmkdir", "+id " + folder.path().string() + " +D " + (folder.path() / "DICOMDIR").string() + " IM1 IM2 IM3");
  if (!answer) GTEST_SKIP() << "dcmmkdir is not there: Debian's package dcmtk has it";
  EXPECT_EQ(answer->second, 0) << answer->first;
  EXPECT_TRUE(fs::exists(folder.path() / "DICOMDIR"));
}

TEST(WriteDicom, RejectsWhatItCannotWrite) {
  const TemporaryFolder folder;
  const CtVolume ct = noisy_ct(straight_grid());
  EXPECT_THAT(error_of([&] { write_dicom(ct, folder.path() / "gone"); }), HasSubstr("no such folder"));
  EXPECT_THAT(error_of([&] { write_dicom(ct, folder.path(), {.series_description = "a\\b"}); }),
              HasSubstr("description"));
  EXPECT_THAT(error_of([&] {
                write_dicom(ct, folder.path(), {.slice_thickness_mm = std::numeric_limits<double>::quiet_NaN()});
              }),
              HasSubstr("thickness"));
  CtVolume short_of_voxels = ct;
  short_of_voxels.hu.pop_back();
  EXPECT_THAT(error_of([&] { write_dicom(short_of_voxels, folder.path()); }), HasSubstr("419 voxels"));
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(WriteDicom, LeavesNothingWhenAFileCannotBeWritten) {
  const TemporaryFolder folder;
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tiny{100, before.rlim_max};  // bytes: as a full disk, writing fails halfway
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tiny), 0);
  const std::string message = error_of([&] { write_dicom(noisy_ct(straight_grid()), folder.path()); });
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_THAT(message, HasSubstr("cannot write"));
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(DicomUid, IsValidAndFollowsItsContent) {
  const std::string uid = dicom_uid_of("a");
  EXPECT_EQ(uid, dicom_uid_of("a"));
  EXPECT_NE(uid, dicom_uid_of("b"));
  EXPECT_TRUE(uid.starts_with("2.25."));
  EXPECT_LE(uid.size(), 44u);
  EXPECT_EQ(uid.substr(5).find_first_not_of("0123456789"), std::string::npos);
  EXPECT_NE(uid[5], '0');
}

}  // namespace
}  // namespace spinaltap
