// A multi-frame CT whose frames contradict each other or say too little.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/staged_output.h"
#include "core/ct/dicom_read.h"
#include "tests/support/error_of.h"
#include "tests/support/made_series.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::error_of;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

/// Each frame with its own orientation, spacing and rescaling.
std::string enhanced_bytes() {
  return test::make_series({.name = "", .is_enhanced = true, .shares_groups = false}).files.at(0).bytes;
}

/// The tag as explicit little endian has it, with its VR.
const std::string kPositionBytes(
    "\x20\x00\x32\x00"
    "DS",
    6);
const std::string kSpacingBytes(
    "\x28\x00\x30\x00"
    "DS",
    6);
const std::string kInterceptBytes(
    "\x28\x00\x52\x10"
    "DS",
    6);
const std::string kSlopeBytes(
    "\x28\x00\x53\x10"
    "DS",
    6);

/// Where a tag stands for the n-th time.
std::size_t find_tag(const std::string& bytes, const std::string& tag, int n) {
  std::size_t at = bytes.find(tag);
  for (; n > 0; --n) at = bytes.find(tag, at + 1);
  EXPECT_NE(at, std::string::npos);
  return at;
}

/// The attribute of one frame becomes one that nobody reads.
std::string without_tag(std::string bytes, const std::string& tag, int frame) {
  bytes[find_tag(bytes, tag, frame) + 2] = '\x77';
  return bytes;
}

CtVolume read_enhanced(const std::string& bytes) {
  const test::TemporaryFolder folder;
  write_whole_file(folder.path() / "enhanced.dcm", bytes);
  return read_dicom(folder.path() / "enhanced.dcm");
}

TEST(EnhancedCt, MustStateRescalingPlaceAndSpacingInEachFrame) {
  EXPECT_EQ(read_enhanced(enhanced_bytes()).geometry.size[2], 6);
  for (const int frame : {0, 3, 5}) {
    const auto error = [&](const std::string& tag) {
      return error_of([&] { read_enhanced(without_tag(enhanced_bytes(), tag, frame)); });
    };
    EXPECT_THAT(error(kInterceptBytes), AllOf(HasSubstr("no RescaleIntercept"), HasSubstr("frame")));
    EXPECT_THAT(error(kSlopeBytes), HasSubstr("no RescaleSlope"));
    EXPECT_THAT(error(kSpacingBytes), HasSubstr("PixelSpacing"));
    EXPECT_THAT(error(kPositionBytes), HasSubstr("ImagePositionPatient"));
  }
}

TEST(EnhancedCt, OfFramesThatDisagreeInRescalingIsDoubtful) {
  std::string bytes = enhanced_bytes();
  const std::size_t value = find_tag(bytes, kInterceptBytes, 2) + 8;
  ASSERT_EQ(bytes.substr(value, 2), "0 ");
  bytes.replace(value, 2, "99");
  EXPECT_THAT(read_enhanced(bytes).warnings,
              Contains(HasSubstr("slices disagree in RescaleIntercept: 0 in 5 of 6, 99 in 1")));
}

TEST(EnhancedCt, OfTwoFramesAtOnePlaceIsRefused) {
  std::string bytes = enhanced_bytes();
  const std::size_t first = find_tag(bytes, kPositionBytes, 0), second = find_tag(bytes, kPositionBytes, 1);
  ASSERT_EQ(bytes[first + 6], bytes[second + 6]);  // values of one length
  const auto length = static_cast<std::size_t>(static_cast<unsigned char>(bytes[first + 6]));
  bytes.replace(second + 8, length, bytes.substr(first + 8, length));
  EXPECT_THAT(error_of([&] { read_enhanced(bytes); }), HasSubstr("one slice at each position"));
}

}  // namespace
}  // namespace spinaltap
