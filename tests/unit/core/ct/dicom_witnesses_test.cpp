// What a series' header says twice, and says otherwise.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/base/staged_output.h"
#include "core/ct/dicom_read.h"
#include "tests/support/error_of.h"
#include "tests/support/hand_made_dicom.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::error_of;
using test::HandMadeDicom;
using test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint32_t kImageTypeTag = 0x00080008, kThicknessTag = 0x00180050, kDiameterTag = 0x00181100,
                        kTiltTag = 0x00181120, kInstanceTag = 0x00200013, kSidesTag = 0x00200020,
                        kPositionTag = 0x00200032, kOrientationTag = 0x00200037, kLocationTag = 0x00201041,
                        kPaddingTag = 0x00280120, kSpacingTag = 0x00280030;

using Change = std::function<void(HandMadeDicom&, int)>;

constexpr int kCountOfSlices = 10;

std::string warning_of(const Change& change) {
  const TemporaryFolder folder;
  for (int k = 0; k < kCountOfSlices; ++k) {
    HandMadeDicom slice;
    slice.set_z(2.0 * k).set(0x00080018, "UI", "1.2.3." + std::to_string(k + 1));
    slice.set(kInstanceTag, "IS", std::to_string(k + 1)).set(kLocationTag, "DS", std::to_string(100 - 2 * k));
    slice.set(kThicknessTag, "DS", "2");
    change(slice, k);
    write_whole_file(folder.path() / ("slice" + std::to_string(100 + k)), slice.bytes());
  }
  const CtVolume ct = read_dicom(folder.path());
  EXPECT_LE(ct.warnings.size(), 2U);
  std::string all;
  for (const std::string& warning : ct.warnings) all += warning + "\n";
  return all;
}

TEST(DicomWitnesses, SayNothingOfAnOrdinarySeries) {
  EXPECT_THAT(warning_of([](HandMadeDicom&, int) {}), IsEmpty());
}

TEST(DicomWitnesses, SlicesThatChangedPlacesAreFoundByWhatCountsThem) {
  const auto swapped = [](HandMadeDicom& slice, int k) { slice.set_z(2.0 * (k == 3 ? 7 : k == 7 ? 3 : k)); };
  EXPECT_THAT(warning_of(swapped), AllOf(HasSubstr("2 of 10 slices do not stand where SliceLocation counts them"),
                                         HasSubstr("where InstanceNumber counts them")));
  EXPECT_THAT(warning_of([&](HandMadeDicom& slice, int k) {
                swapped(slice, k);
                slice.remove(kLocationTag);
              }),
              HasSubstr("InstanceNumber"));
}

TEST(DicomWitnesses, NumbersThatDoNotCountEvenlyAreNone) {
  // Two blocks, the upper one first; no numbers; one that is odd.
  EXPECT_THAT(warning_of([](HandMadeDicom& slice, int k) {
                slice.set(kInstanceTag, "IS", std::to_string((k + 5) % kCountOfSlices)).remove(kLocationTag);
              }),
              IsEmpty());
  EXPECT_THAT(warning_of([](HandMadeDicom& slice, int) { slice.remove(kInstanceTag).remove(kLocationTag); }),
              IsEmpty());
  EXPECT_THAT(warning_of([](HandMadeDicom& slice, int k) {
                if (k == 4) slice.set(kInstanceTag, "IS", "1000");
              }),
              IsEmpty());
}

TEST(DicomWitnesses, StepsThatSliceLocationCountsOtherwiseAreDoubtful) {
  EXPECT_THAT(warning_of([](HandMadeDicom& slice, int k) { slice.set_z(1.0 * k); }),
              HasSubstr("positions are 1 mm apart, SliceLocation counts 2 mm"));
}

TEST(DicomWitnesses, ThicknessIsHeldAgainstTheStepOnlyWhereItIsAbsurd) {
  const auto of = [](const char* thickness_mm) {
    return warning_of([&](HandMadeDicom& slice, int) { slice.set(kThicknessTag, "DS", thickness_mm); });
  };
  for (const char* usual : {"1", "1.25", "2", "3", "5"}) EXPECT_THAT(of(usual), IsEmpty()) << usual;
  EXPECT_THAT(of("0.6"), HasSubstr("slices 0.6 mm thick stand 2 mm apart: what lies between them was not seen"));
  EXPECT_THAT(of("25"), HasSubstr("positions may be wrong"));
}

TEST(DicomWitnesses, PatientOrientationIsHeldAgainstTheDirections) {
  const auto of = [](const char* sides, const char* directions) {
    return warning_of([&](HandMadeDicom& slice, int) {
      slice.set(kSidesTag, "CS", sides)
          .set(kOrientationTag, "DS", directions)
          .remove(kLocationTag)
          .remove(kInstanceTag);
    });
  };
  const char* const kAxial = "1\\0\\0\\0\\1\\0";
  EXPECT_THAT(of("L\\P", kAxial), IsEmpty());
  EXPECT_THAT(of("LA\\PF", "0.9\\-0.435889894\\0\\0.435889894\\0.9\\0"), IsEmpty());
  EXPECT_THAT(of("", kAxial), IsEmpty());
  EXPECT_THAT(of("R\\P", kAxial), HasSubstr("left and right, or front and back, may be exchanged"));
  EXPECT_THAT(of("L\\A", kAxial), HasSubstr("PatientOrientation says that pixels run to L and A"));
  EXPECT_THAT(of("P\\L", kAxial), HasSubstr("PatientOrientation"));
}

TEST(DicomWitnesses, TheDiameterIsHeldAgainstPixelsAndTheirNumber) {
  const auto of = [](const char* diameter_mm) {
    return warning_of([&](HandMadeDicom& slice, int) { slice.set(kDiameterTag, "DS", diameter_mm); });
  };
  // Four pixels of 0.25 mm, three of 0.5: a part that was cut out may be smaller.
  EXPECT_THAT(of("1.5"), IsEmpty());
  EXPECT_THAT(of("360"), IsEmpty());
  EXPECT_THAT(of("1.2"), HasSubstr("ReconstructionDiameter is 1.2 mm"));
}

TEST(DicomWitnesses, PixelsOfScannersAreSquare) {
  const auto of = [](const char* type, const char* spacing) {
    return warning_of(
        [&](HandMadeDicom& slice, int) { slice.set(kImageTypeTag, "CS", type).set(kSpacingTag, "DS", spacing); });
  };
  EXPECT_THAT(of("ORIGINAL\\PRIMARY\\AXIAL", "0.5\\0.5"), IsEmpty());
  EXPECT_THAT(of("DERIVED\\SECONDARY\\REFORMATTED", "0.5\\0.25"), IsEmpty());
  EXPECT_THAT(of("ORIGINAL\\PRIMARY\\AXIAL", "0.5\\0.25"), HasSubstr("not square"));
}

TEST(DicomWitnesses, DriftIsAGantrysWhereTheHeaderSaysSo) {
  const auto of = [](double along_x, double along_y, const char* tilt_deg) {
    return warning_of([&](HandMadeDicom& slice, int k) {
      slice.set(kPositionTag, "DS",
                std::to_string(along_x * k) + "\\" + std::to_string(along_y * k) + "\\" + std::to_string(0.3 * k));
      slice.set(kThicknessTag, "DS", "0.3").remove(kLocationTag);
      if (tilt_deg != nullptr) slice.set(kTiltTag, "DS", tilt_deg);
    });
  };
  const double drift = 0.3 * std::tan(0.2617994);  // of 15 degrees
  EXPECT_THAT(of(0.0, drift, "15"), IsEmpty());
  EXPECT_THAT(of(0.0, -drift, "15"), IsEmpty());
  EXPECT_THAT(of(0.0, drift, "-15"), IsEmpty());
  EXPECT_THAT(of(0.0, drift, nullptr), HasSubstr("GantryDetectorTilt says nothing"));
  EXPECT_THAT(of(0.0, drift, "5"), HasSubstr("GantryDetectorTilt says 5"));
  EXPECT_THAT(of(drift, 0.0, "15"), HasSubstr("drift along their rows"));
}

TEST(DicomWitnesses, PaddingThatTissueHasIsDoubtful) {
  const auto of = [](int padding) {
    return warning_of([&](HandMadeDicom& slice, int) { slice.set_short(kPaddingTag, padding); });
  };
  // Stored values are CT numbers + 1024.
  EXPECT_THAT(of(0), IsEmpty());
  EXPECT_THAT(of(63536), IsEmpty());
  EXPECT_THAT(of(1024), HasSubstr("PixelPaddingValue is a CT number that tissue has, 0 HU"));
}

TEST(DicomWitnesses, BytesBeyondTheSizesAreDoubtful) {
  EXPECT_THAT(warning_of([](HandMadeDicom& slice, int) { slice.set_short(0x00280010, 2); }),
              HasSubstr("PixelData is longer than Rows, Columns and BitsAllocated say, by 8 bytes, in 10 of 10"));
}

TEST(DicomWitnesses, RescalingIsOneNumberAboveZero) {
  const auto error = [](std::uint32_t tag, const char* value) {
    return error_of([&] { warning_of([&](HandMadeDicom& slice, int) { slice.set(tag, "DS", value); }); });
  };
  EXPECT_THAT(error(0x00281053, "-1"), HasSubstr("RescaleSlope above 0"));
  EXPECT_THAT(error(0x00281053, "1\\1"), HasSubstr("one RescaleSlope"));
  EXPECT_THAT(error(0x00281052, "0\\-1024"), HasSubstr("one RescaleSlope and one RescaleIntercept, found 1 and 2"));
  EXPECT_THAT(error(kSpacingTag, "0.5\\102.4"), HasSubstr("below 25 mm"));
}

}  // namespace
}  // namespace spinaltap
