#include "core/ct/dicom_read.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <tbb/global_control.h>

#include "core/base/staged_output.h"
#include "tests/support/error_of.h"
#include "tests/support/hand_made_dicom.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::HandMadeDicom;
using test::TemporaryFolder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// Three slices 2 mm apart; `change` alters the slice of a number.
template <class Change>
void write_series(const fs::path& folder, const Change& change) {
  for (int k = 0; k < 3; ++k) {
    HandMadeDicom slice;
    slice.set_z(2.0 * k);
    change(slice, k);
    write_whole_file(folder / ("slice" + std::to_string(k)), slice.bytes());
  }
}

template <class Change>
std::string error_of_series(const Change& change) {
  const TemporaryFolder folder;
  write_series(folder.path(), change);
  return error_of([&] { read_dicom(folder.path()); });
}

const auto kUnchanged = [](HandMadeDicom&, int) {};

TEST(ReadDicom, GivesHuAndGeometryOfAHandMadeSeries) {
  const TemporaryFolder folder;
  write_series(folder.path(), kUnchanged);
  const CtVolume ct = read_dicom(folder.path());
  EXPECT_THAT(ct.geometry.size, ElementsAre(4, 3, 3));
  EXPECT_EQ(ct.geometry.spacing_mm, Vec3(0.25, 0.5, 2.0));  // PixelSpacing is row step \ column step
  EXPECT_EQ(ct.geometry.origin_mm, Vec3(0.0, 0.0, 0.0));
  EXPECT_EQ(ct.geometry.directions, Mat3::Identity());
  EXPECT_EQ(ct.at(0, 0, 0), 100 - 1024);
  EXPECT_EQ(ct.at(1, 2, 2), 100 + 9 - 1024);
}

TEST(ReadDicom, ReadsImplicitValueRepresentations) {
  const TemporaryFolder folder;
  write_series(folder.path(), [](HandMadeDicom& slice, int) { slice.make_implicit(); });
  EXPECT_EQ(read_dicom(folder.path()).at(3, 2, 1), 111 - 1024);
}

TEST(ReadDicom, ReadsSignedTwelveBitValues) {
  const TemporaryFolder folder;
  write_series(folder.path(), [](HandMadeDicom& slice, int) {
    // -5 in 12 bits is 0xffb; the four bits above may hold anything.
    slice.set_short(0x00280101, 12).set_short(0x00280102, 11).set_short(0x00280103, 1).set(0x00281052, "DS", "0");
    slice.set_pixels(std::vector<std::uint16_t>(12, 0x3ffb));
  });
  EXPECT_EQ(read_dicom(folder.path()).at(0, 0, 0), -5);
}

TEST(ReadDicom, RoundsAndClampsToSixteenBits) {
  const TemporaryFolder folder;
  write_series(folder.path(), [](HandMadeDicom& slice, int) {
    slice.set(0x00281053, "DS", "1.5").set(0x00281052, "DS", "-1024");
    slice.set_pixels({0, 1, 2, 3, 65535, 0, 0, 0, 0, 0, 0, 0});
  });
  const CtVolume ct = read_dicom(folder.path());
  EXPECT_EQ(ct.at(0, 0, 0), -1024);
  EXPECT_EQ(ct.at(1, 0, 0), -1023);  // -1022.5 is rounded away from zero
  EXPECT_EQ(ct.at(2, 0, 0), -1021);
  EXPECT_EQ(ct.at(0, 1, 0), 32767);
}

TEST(ReadDicom, MakesAirOfPaddingAndItsRange) {
  const TemporaryFolder folder;
  write_series(folder.path(), [](HandMadeDicom& slice, int) {
    slice.set_short(0x00280120, 105).set_short(0x00280121, 102).set(0x00281052, "DS", "0");
  });
  const CtVolume ct = read_dicom(folder.path());
  EXPECT_EQ(ct.at(1, 0, 0), 101);
  EXPECT_EQ(ct.at(2, 0, 0), -1024);
  EXPECT_EQ(ct.at(1, 1, 0), -1024);
  EXPECT_EQ(ct.at(2, 1, 0), 106);
}

TEST(ReadDicom, KeepsValuesBelowAirThatAreNotCalledPadding) {
  const TemporaryFolder folder;
  write_series(folder.path(), [](HandMadeDicom& slice, int) {
    slice.set_short(0x00280103, 1).set_pixels(std::vector<std::uint16_t>(12, static_cast<std::uint16_t>(-2000)));
  });
  EXPECT_EQ(read_dicom(folder.path()).at(0, 0, 0), -3024);
}

TEST(ReadDicom, SortsByPositionAndNotByName) {
  const TemporaryFolder folder;
  write_series(folder.path(), [](HandMadeDicom& slice, int k) {
    slice.set_z(std::vector<double>{4.0, 0.0, 2.0}[static_cast<std::size_t>(k)]);
    slice.set_pixels(std::vector<std::uint16_t>(12, static_cast<std::uint16_t>(k)));
  });
  const CtVolume ct = read_dicom(folder.path());
  EXPECT_EQ(ct.at(0, 0, 0), 1 - 1024);
  EXPECT_EQ(ct.at(0, 0, 1), 2 - 1024);
  EXPECT_EQ(ct.at(0, 0, 2), 0 - 1024);
}

TEST(ReadDicom, TakesTheThirdAxisAlongTheNormalOfTheSlices) {
  const TemporaryFolder folder;
  // Rows run to the patient's back-to-front: the normal points down, so the slice of highest z comes first.
  write_series(folder.path(), [](HandMadeDicom& slice, int) { slice.set(0x00200037, "DS", "1\\0\\0\\0\\-1\\0"); });
  const CtVolume ct = read_dicom(folder.path());
  EXPECT_EQ(ct.geometry.directions.col(2), Vec3(0.0, 0.0, -1.0));
  EXPECT_EQ(ct.geometry.origin_mm, Vec3(0.0, 0.0, 4.0));
}

TEST(ReadDicom, TakesTheMeanStepOfRoundedPositions) {
  const TemporaryFolder folder;
  for (int k = 0; k < 5; ++k) {  // 0.625 mm, rounded to 0.01 mm in the files
    HandMadeDicom slice;
    slice.set_z(std::vector<double>{0.0, 0.63, 1.25, 1.88, 2.5}[static_cast<std::size_t>(k)]);
    write_whole_file(folder.path() / std::to_string(k), slice.bytes());
  }
  EXPECT_DOUBLE_EQ(read_dicom(folder.path()).geometry.spacing_mm.z(), 0.625);
}

TEST(ReadDicom, DoesNotDependOnTheNumberOfThreads) {
  const TemporaryFolder folder;
  write_series(folder.path(), kUnchanged);
  const std::string hash = read_dicom(folder.path()).source_hash;
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(read_dicom(folder.path()).source_hash, hash);
}

TEST(ReadDicom, StopsWhenCancelled) {
  const TemporaryFolder folder;
  write_series(folder.path(), kUnchanged);
  const Progress progress([](std::string_view, double) {});
  progress.cancel();
  EXPECT_THROW(read_dicom(folder.path(), {}, progress), Cancelled);
}

TEST(ReadDicom, NamesAMissingFolderAFileAndAFolderWithoutDicom) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { read_dicom(folder.path() / "gone"); }), HasSubstr("no such folder"));
  write_whole_file(folder.path() / "notes.txt", "not DICOM");
  EXPECT_THAT(error_of([&] { read_dicom(folder.path() / "notes.txt"); }),
              HasSubstr("expected DICOM images, found none among 1 file in"));
  EXPECT_THAT(error_of([&] { read_dicom(folder.path()); }), HasSubstr("found none among 1 file in"));
}

TEST(ReadDicom, SaysWhichModalityItFound) {
  EXPECT_THAT(error_of_series([](HandMadeDicom& slice, int) { slice.set(0x00080060, "CS", "MR"); }),
              HasSubstr("expected a CT, found modality MR"));
}

TEST(ReadDicom, ListsSeveralSeriesAndReadsTheChosenOne) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "a");
  fs::create_directory(folder.path() / "b");
  write_series(folder.path() / "a", [](HandMadeDicom& slice, int) { slice.set(0x0020000e, "UI", "1.2.9"); });
  write_series(folder.path() / "b",
               [](HandMadeDicom& slice, int) { slice.set_pixels(std::vector<std::uint16_t>(12)); });
  EXPECT_THAT(error_of([&] { read_dicom(folder.path()); }),
              AllOf(HasSubstr("found 2"), HasSubstr("CtReadOptions::series"),
                    HasSubstr("1 = 1.2.3 (CT, 4 x 3, 3 files)"), HasSubstr("2 = 1.2.9 (CT, 4 x 3, 3 files)")));
  try {
    read_dicom(folder.path());
    ADD_FAILURE() << "several series were read";
  } catch (const SeveralSeries& several) {
    ASSERT_EQ(several.series.size(), 2U);
    EXPECT_EQ(several.series[1].uid, "1.2.9");
  }
  EXPECT_EQ(read_dicom(folder.path(), {.series = "1"}).at(1, 0, 0), -1024);
  EXPECT_EQ(read_dicom(folder.path(), {.series = "1.2.9"}).at(1, 0, 0), 101 - 1024);
  EXPECT_THAT(error_of([&] { read_dicom(folder.path(), {.series = "3"}); }),
              AllOf(HasSubstr("no series \"3\""), HasSubstr("2 = 1.2.9")));
}

TEST(ReadDicom, RejectsSlicesOfUnequalSizeOrOrientation) {
  const auto wider = [](HandMadeDicom& slice, int k) {
    if (k == 1) slice.set_short(0x00280011, 6).set_short(0x00280010, 2);
  };
  EXPECT_THAT(error_of_series(wider), AllOf(HasSubstr("one size and orientation"), HasSubstr("6 x 2, 1 file")));
  const auto turned = [](HandMadeDicom& slice, int k) {
    if (k == 1) slice.set(0x00200037, "DS", "0\\1\\0\\0\\0\\-1");
  };
  EXPECT_THAT(error_of_series(turned), HasSubstr("one size and orientation"));
}

TEST(ReadDicom, RejectsWhatItCannotTurnIntoHu) {
  const auto with = [](std::uint32_t tag, const char* vr, const char* value) {
    return error_of_series([=](HandMadeDicom& slice, int k) {
      if (k == 1) slice.set(tag, vr, value);
    });
  };
  EXPECT_THAT(with(0x00281053, "DS", "0"), AllOf(HasSubstr("RescaleSlope"), HasSubstr("slice1")));
  EXPECT_THAT(with(0x00281052, "DS", "abc"), AllOf(HasSubstr("RescaleIntercept"), HasSubstr("slice1")));
  EXPECT_THAT(with(0x00280008, "IS", "2"),
              AllOf(HasSubstr("expected 2 frames of 24 bytes, found 24 bytes"), HasSubstr("slice1")));
  EXPECT_THAT(with(0x00280004, "CS", "RGB"), AllOf(HasSubstr("grey"), HasSubstr("slice1")));
  EXPECT_THAT(error_of_series([](HandMadeDicom& slice, int) { slice.remove(0x00281052); }),
              HasSubstr("no RescaleIntercept"));
  EXPECT_THAT(error_of_series([](HandMadeDicom& slice, int) { slice.set_short(0x00280102, 3); }),
              HasSubstr("highest at 3"));
  EXPECT_THAT(error_of_series([](HandMadeDicom& slice, int) { slice.set_transfer_syntax("1.2.840.10008.1.2.4.100"); }),
              HasSubstr("transfer syntax for pictures"));  // MPEG-2
  EXPECT_THAT(error_of_series([](HandMadeDicom& slice, int) { slice.set_transfer_syntax("9.9"); }),
              HasSubstr("\"9.9\""));
}

TEST(ReadDicom, RejectsAbsurdSizesBeforeItTakesMemory) {
  EXPECT_THAT(error_of_series(
                  [](HandMadeDicom& slice, int) { slice.set_short(0x00280010, 65535).set_short(0x00280011, 65535); }),
              HasSubstr("at most"));
  EXPECT_THAT(error_of_series([](HandMadeDicom& slice, int) { slice.set_short(0x00280010, 0); }),
              HasSubstr("at least one voxel"));
}

TEST(ReadDicom, NamesAFileCutShortAtAnyByte) {
  const TemporaryFolder folder;
  write_series(folder.path(), kUnchanged);
  const fs::path cut = folder.path() / "slice1";
  const std::string whole = read_whole_file(cut);
  for (std::size_t size = 132; size < whole.size(); ++size) {
    write_whole_file(cut, whole.substr(0, size));
    EXPECT_THAT(error_of([&] { read_dicom(folder.path()); }), HasSubstr("slice1")) << "cut at byte " << size;
  }
}

TEST(ReadDicom, SurvivesAnyWrongByte) {
  const TemporaryFolder folder;
  write_series(folder.path(), kUnchanged);
  const fs::path broken = folder.path() / "slice1";
  const std::string whole = read_whole_file(broken);
  for (std::size_t n = 128; n < whole.size(); ++n) {
    for (const char byte : {'\0', '\x7f', '\xff'}) {
      std::string bytes = whole;
      bytes[n] = byte;
      write_whole_file(broken, bytes);
      error_of([&] { read_dicom(folder.path()); });  // reads it or throws Error; anything else ends the test
    }
  }
}

TEST(ListDicomSeries, SurvivesLoopsOfLinksAndFilesThatAreNone) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "deep");
  write_series(folder.path() / "deep", kUnchanged);
  fs::create_directory_symlink(folder.path(), folder.path() / "deep" / "loop");
  fs::create_symlink(folder.path() / "itself", folder.path() / "itself");
  fs::create_symlink(folder.path() / "gone", folder.path() / "dangling");
  ASSERT_EQ(::mkfifo((folder.path() / "fifo").c_str(), 0600), 0);
  write_whole_file(folder.path() / "secret", "x");
  fs::permissions(folder.path() / "secret", fs::perms::none);
  const std::vector<SeriesInfo> series = list_dicom_series(folder.path());
  ASSERT_EQ(series.size(), 1u);
  EXPECT_EQ(series[0].uid, "1.2.3");
  EXPECT_EQ(series[0].number, 1);
  EXPECT_EQ(series[0].modality, "CT");
  EXPECT_EQ(series[0].columns, 4);
  EXPECT_EQ(series[0].rows, 3);
  EXPECT_THAT(series[0].files, ElementsAre(folder.path() / "deep" / "slice0", folder.path() / "deep" / "slice1",
                                           folder.path() / "deep" / "slice2"));
}

}  // namespace
}  // namespace spinaltap
