// What may stand in one series and must not be read as one volume, and what must.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "core/base/staged_output.h"
#include "core/ct/dicom_read.h"
#include "core/ct/read_ct.h"
#include "tests/support/error_of.h"
#include "tests/support/hand_made_dicom.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::error_of;
using test::HandMadeDicom;
using test::TemporaryFolder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint32_t kInstanceUid = 0x00080018, kImageType = 0x00080008, kTime = 0x00080032, kKvp = 0x00180060,
                        kKernel = 0x00181210, kAcquisition = 0x00200012, kFrameOfReference = 0x00200052,
                        kTemporal = 0x00200100, kIntercept = 0x00281052, kSlope = 0x00281053, kRescaleType = 0x00281054,
                        kLut = 0x00283000;

using Change = std::function<void(HandMadeDicom&, int)>;

HandMadeDicom slice_of(int k, double z_mm, const Change& change) {
  HandMadeDicom slice;
  slice.set_z(z_mm).set(kInstanceUid, "UI", "1.2.3." + std::to_string(k + 1));
  slice.set_pixels(std::vector<std::uint16_t>(12, static_cast<std::uint16_t>(1000 + k)));
  change(slice, k);
  return slice;
}

/// `count` slices 2 mm apart; of each its number as CT number, less 24.
void write_slices(const std::filesystem::path& folder, int count, const Change& change) {
  for (int k = 0; k < count; ++k) {
    write_whole_file(folder / ("slice" + std::to_string(100 + k)), slice_of(k, 2.0 * k, change).bytes());
  }
}

std::vector<SeriesInfo> listed(int count, const Change& change) {
  const TemporaryFolder folder;
  write_slices(folder.path(), count, change);
  return list_dicom_series(folder.path());
}

std::vector<int> slices_of(const std::vector<SeriesInfo>& series) {
  std::vector<int> counts;
  for (const SeriesInfo& one : series) counts.push_back(one.slices);
  return counts;
}

TEST(DicomParts, TwoFramesOfReferenceAreTwoStacksAndNeverOneVolume) {
  const TemporaryFolder folder;
  write_slices(folder.path(), 9,
               [](HandMadeDicom& slice, int k) { slice.set(kFrameOfReference, "UI", k < 5 ? "1.7" : "1.8"); });
  const std::vector<SeriesInfo> series = list_dicom_series(folder.path());
  EXPECT_THAT(slices_of(series), ElementsAre(5, 4));
  EXPECT_EQ(series[0].told_apart_by, "FrameOfReferenceUID");
  EXPECT_EQ(series[1].stack, 2);
  for (const bool resample : {false, true}) {
    EXPECT_THAT(error_of([&] { read_dicom(folder.path(), {.resample = resample}); }),
                AllOf(HasSubstr("one frame of reference, found 2 stacks"), HasSubstr("CtReadOptions::stack")));
  }
  const CtVolume second = read_ct(folder.path(), {.stack = 2});
  EXPECT_THAT(second.geometry.size, ElementsAre(4, 3, 4));
  EXPECT_EQ(second.at(0, 0, 0), 1005 - 1024);
  EXPECT_THAT(error_of([&] { read_dicom(folder.path(), {.stack = 3}); }), HasSubstr("no stack 3"));
}

TEST(DicomParts, AFrameOfReferenceOfEachSliceSaysNothing) {
  const std::vector<SeriesInfo> series = listed(
      9, [](HandMadeDicom& slice, int k) { slice.set(kFrameOfReference, "UI", "1.9." + std::to_string(k + 1)); });
  ASSERT_THAT(slices_of(series), ElementsAre(9));
  EXPECT_THAT(series[0].notes, ElementsAre(HasSubstr("9 FrameOfReferenceUIDs in 9 slices")));
  EXPECT_THAT(series[0].warnings, IsEmpty());
}

TEST(DicomParts, KernelVoltageAndImageTypePartWhereTwoSlicesShareThem) {
  const std::vector<std::tuple<std::uint32_t, const char*, const char*>> kinds{
      {kKernel, "B30f", "B70f"}, {kKvp, "80", "140"}, {kImageType, "ORIGINAL\\PRIMARY\\AXIAL", "DERIVED\\SECONDARY"}};
  for (const auto& [tag, one, other] : kinds) {
    const std::vector<SeriesInfo> series =
        listed(8, [tag = tag, one = one, other = other](HandMadeDicom& slice, int k) {
          slice.set(tag, "CS", k % 2 == 0 ? one : other);
        });
    EXPECT_THAT(slices_of(series), ElementsAre(4, 4)) << one;
  }
}

TEST(DicomParts, OneSliceOfAnotherKernelIsWarnedOf) {
  const TemporaryFolder folder;
  write_slices(folder.path(), 8,
               [](HandMadeDicom& slice, int k) { slice.set(kKernel, "SH", k == 3 ? "B70f" : "B30f"); });
  EXPECT_THAT(read_dicom(folder.path()).warnings,
              ElementsAre(AllOf(HasSubstr("ConvolutionKernel of one slice"), HasSubstr("at 0, 0, 6 mm"))));
}

TEST(DicomParts, OneVoltageWrittenInTwoWaysIsOne) {
  const std::vector<SeriesInfo> series =
      listed(8, [](HandMadeDicom& slice, int k) { slice.set(kKvp, "DS", k % 2 == 0 ? "120" : "120.0"); });
  ASSERT_THAT(slices_of(series), ElementsAre(8));
  EXPECT_THAT(series[0].warnings, IsEmpty());
}

TEST(DicomParts, PhasesAtTheSamePlacesAreStacks) {
  const std::vector<std::tuple<std::uint32_t, const char*, const char*>> kinds{
      {kTemporal, "1", "2"}, {kAcquisition, "3", "4"}, {kTime, "100000", "100200"}};
  for (const auto& [tag, one, other] : kinds) {
    const TemporaryFolder folder;
    for (int k = 0; k < 10; ++k) {
      HandMadeDicom slice = slice_of(k, 2.0 * (k % 5), [](HandMadeDicom&, int) {});
      slice.set(tag, "IS", k < 5 ? one : other);
      write_whole_file(folder.path() / std::to_string(100 + k), slice.bytes());
    }
    EXPECT_THAT(slices_of(list_dicom_series(folder.path())), ElementsAre(5, 5)) << one;
    EXPECT_EQ(read_dicom(folder.path(), {.stack = 2}).at(0, 0, 0), 1005 - 1024) << one;
  }
}

TEST(DicomParts, AcquisitionsThatTakeTurnsAlongTheStackAreStacks) {
  EXPECT_THAT(
      slices_of(listed(10, [](HandMadeDicom& slice, int k) { slice.set(kAcquisition, "IS", k % 2 == 0 ? "1" : "2"); })),
      ElementsAre(5, 5));
  EXPECT_THAT(slices_of(listed(10,
                               [](HandMadeDicom& slice, int k) {
                                 slice.set(kTime, "TM", (k % 2 == 0 ? "10000" : "10050") + std::to_string(k / 2));
                               })),
              ElementsAre(5, 5));
}

TEST(DicomParts, OrdinarySeriesWhoseNumbersAndTimesCountOnStayOne) {
  const std::vector<Change> kinds{
      [](HandMadeDicom& slice, int k) { slice.set(kAcquisition, "IS", std::to_string(k + 1)); },      // each its own
      [](HandMadeDicom& slice, int k) { slice.set(kAcquisition, "IS", std::to_string(1 + k / 3)); },  // step and shoot
      [](HandMadeDicom& slice, int k) { slice.set(kTime, "TM", "1000" + std::to_string(10 + k) + ".25"); },
      [](HandMadeDicom& slice, int k) { slice.set(kTime, "TM", "10" + std::to_string(10 + k / 3) + "00"); },
      [](HandMadeDicom& slice, int k) {
        if (k == 4) slice.set(kKernel, "SH", "B30f");  // the others do not say
      }};
  for (const Change& change : kinds) {
    const std::vector<SeriesInfo> series = listed(12, change);
    ASSERT_THAT(slices_of(series), ElementsAre(12));
    EXPECT_THAT(series[0].warnings, IsEmpty());
  }
}

TEST(DicomParts, CopiesCountOnce) {
  const TemporaryFolder folder;
  write_slices(folder.path(), 6, [](HandMadeDicom&, int) {});
  const CtVolume once = read_dicom(folder.path());
  EXPECT_THAT(once.notes, IsEmpty());
  write_slices(folder.path() / "again", 0, [](HandMadeDicom&, int) {});
  std::filesystem::create_directories(folder.path() / "again");
  write_slices(folder.path() / "again", 3, [](HandMadeDicom&, int) {});
  // Under a UID of its own, as some exports name each copy.
  std::filesystem::create_directories(folder.path() / "renamed");
  write_slices(folder.path() / "renamed", 2,
               [](HandMadeDicom& slice, int k) { slice.set(kInstanceUid, "UI", "1.2.9." + std::to_string(k)); });
  const CtVolume ct = read_dicom(folder.path());
  EXPECT_EQ(ct.source_hash, once.source_hash);
  EXPECT_THAT(ct.notes, ElementsAre(HasSubstr("5 of 11 slices are copies")));
  EXPECT_THAT(ct.warnings, IsEmpty());
}

TEST(DicomParts, OneInstanceUidWithTwoContentsIsRefused) {
  const TemporaryFolder folder;
  write_slices(folder.path(), 6, [](HandMadeDicom& slice, int k) {
    if (k == 4) slice.set(kInstanceUid, "UI", "1.2.3.1");
  });
  EXPECT_THAT(error_of([&] { read_dicom(folder.path()); }),
              AllOf(HasSubstr("each SOPInstanceUID"), HasSubstr("slice100"), HasSubstr("slice104")));
}

TEST(DicomParts, FilesWithoutPreambleAreReadAndOthersCounted) {
  const TemporaryFolder folder;
  for (const bool is_implicit : {false, true}) {
    for (int k = 0; k < 6; ++k) {
      HandMadeDicom slice = slice_of(k, 2.0 * k, [](HandMadeDicom&, int) {});
      if (is_implicit) slice.make_implicit();
      std::string bytes = slice.bytes();
      // Without the preamble, and every second one without group 0002 as well, whose length its first element states.
      const auto meta = static_cast<std::size_t>(static_cast<unsigned char>(bytes[140]));
      bytes.erase(0, k % 2 == 0 ? 132 : 132 + 12 + meta);
      write_whole_file(folder.path() / std::to_string(k), bytes);
    }
    const CtVolume ct = read_dicom(folder.path());
    EXPECT_THAT(ct.geometry.size, ElementsAre(4, 3, 6));
    EXPECT_EQ(ct.at(3, 2, 5), 1005 - 1024);
    EXPECT_THAT(ct.notes, IsEmpty());
  }
  write_whole_file(folder.path() / "readme.txt", "these are slices");
  write_whole_file(folder.path() / "DICOMDIR", HandMadeDicom()
                                                   .set(0x00080016, "UI", "1.2.840.10008.1.3.10")
                                                   .remove(0x00280010)
                                                   .remove(0x00280011)
                                                   .remove(0x7fe00010)
                                                   .bytes());
  EXPECT_THAT(read_dicom(folder.path()).notes,
              ElementsAre("passed over 2 of 8 files: 1 a directory (DICOMDIR), 1 not DICOM"));
}

TEST(DicomParts, PositionsRoundedToTenthsAreEvenSteps) {
  const TemporaryFolder folder;
  for (int k = 0; k < 20; ++k) {
    const double z_mm = std::round(10.0 * (-103.2 + 0.625 * k)) / 10.0;
    write_whole_file(folder.path() / std::to_string(100 + k), slice_of(k, z_mm, [](HandMadeDicom&, int) {}).bytes());
  }
  const CtVolume ct = read_dicom(folder.path());
  EXPECT_NEAR(ct.geometry.spacing_mm.z(), 0.625, 0.1 / 19.0);  // what rounding both ends leaves open
  EXPECT_THAT(ct.notes, ElementsAre(HasSubstr("rounded to 0.1 mm")));
  // What the files state is taken where positions allow it, and not where they do not.
  for (const auto& [stated, expected] : {std::pair("0.625", true), std::pair("0.7", false)}) {
    for (int k = 0; k < 20; ++k) {
      HandMadeDicom slice = slice_of(k, std::round(10.0 * 0.625 * k) / 10.0, [](HandMadeDicom&, int) {});
      slice.set(0x00180088, "DS", stated);
      write_whole_file(folder.path() / std::to_string(100 + k), slice.bytes());
    }
    EXPECT_EQ(read_dicom(folder.path()).geometry.spacing_mm.z() == 0.625, expected);
  }
}

TEST(DicomParts, UnevenPositionsOfTenthsStayUneven) {
  const TemporaryFolder folder;
  for (int k = 0; k < 20; ++k) {
    write_whole_file(folder.path() / std::to_string(100 + k),
                     slice_of(k, k < 10 ? 0.6 * k : 6.0 + 0.8 * (k - 10), [](HandMadeDicom&, int) {}).bytes());
  }
  EXPECT_THAT(error_of([&] { read_dicom(folder.path()); }), HasSubstr("unevenly spaced"));
}

std::string error_with(const Change& change) {
  const TemporaryFolder folder;
  write_slices(folder.path(), 6, change);
  return error_of([&] { read_dicom(folder.path()); });
}

TEST(DicomRescale, SlopeAndInterceptMustBeThereInEachSlice) {
  for (const int only : {-1, 3}) {
    for (const bool is_signed : {false, true}) {
      const auto change = [&](std::vector<std::uint32_t> tags) {
        return [=](HandMadeDicom& slice, int k) {
          if (is_signed) slice.set_short(0x00280103, 1);
          for (const std::uint32_t tag : tags) {
            if (only < 0 || only == k) slice.remove(tag);
          }
        };
      };
      EXPECT_THAT(error_with(change({kIntercept})), HasSubstr("found no RescaleIntercept"));
      EXPECT_THAT(error_with(change({kSlope})), HasSubstr("found no RescaleSlope"));
      EXPECT_THAT(error_with(change({kSlope, kIntercept})), HasSubstr("RescaleSlope and no RescaleIntercept"));
    }
  }
}

TEST(DicomRescale, AUnitOtherThanHuAndAModalityLutAreRefused) {
  for (const char* type : {"ED", "Z_EFF", "EDW", "OD", "MGML", "PCT"}) {
    EXPECT_THAT(error_with([&](HandMadeDicom& slice, int k) {
                  if (k == 2) slice.set(kRescaleType, "LO", type);
                }),
                HasSubstr(std::string("the RescaleType ") + type));
  }
  EXPECT_THAT(error_with([](HandMadeDicom& slice, int) { slice.set(kLut, "SQ", std::string(8, '\0')); }),
              HasSubstr("Modality LUT"));
}

TEST(DicomRescale, HuIsReadUnspecifiedIsDoubtful) {
  const auto warnings_with = [](const char* type) {
    const TemporaryFolder folder;
    write_slices(folder.path(), 6, [&](HandMadeDicom& slice, int) { slice.set(kRescaleType, "LO", type); });
    return read_dicom(folder.path()).warnings;
  };
  EXPECT_THAT(warnings_with("HU"), IsEmpty());
  EXPECT_THAT(warnings_with(""), IsEmpty());
  EXPECT_THAT(warnings_with("US"), ElementsAre(HasSubstr("RescaleType US")));
  EXPECT_THAT(warnings_with("HU_MOD"), ElementsAre(HasSubstr("HU_MOD")));
}

TEST(DicomRescale, SlicesThatDisagreeAreDoubtful) {
  const auto warnings_with = [](std::uint32_t tag, const char* value) {
    const TemporaryFolder folder;
    write_slices(folder.path(), 6, [&](HandMadeDicom& slice, int k) {
      if (k == 2) slice.set(tag, "DS", value);
    });
    return read_dicom(folder.path()).warnings;
  };
  EXPECT_THAT(warnings_with(kIntercept, "0"),
              ElementsAre(HasSubstr("disagree in RescaleIntercept: -1024 in 5 of 6, 0")));
  EXPECT_THAT(warnings_with(kSlope, "10"), ElementsAre(HasSubstr("disagree in RescaleSlope")));
}

TEST(DicomRescale, WhoKnowsTheUnitSaysIt) {
  const TemporaryFolder folder;
  write_slices(folder.path(), 6, [](HandMadeDicom& slice, int) { slice.remove(kIntercept).remove(kSlope); });
  EXPECT_THROW(read_ct(folder.path()), Error);
  const CtVolume ct = read_ct(folder.path(), {.hu = {.scale = 1.0, .offset = -1024.0}});
  EXPECT_EQ(ct.at(0, 0, 3), 1003 - 1024);
  EXPECT_EQ(ct.hu_change.offset, -1024.0);
  EXPECT_THROW(read_ct(folder.path(), {.hu = {.scale = 0.0, .offset = 1.0}}), Error);
}

}  // namespace
}  // namespace spinaltap
