#include "core/ct/detail/dicom_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_of.h"

namespace spinaltap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Two compressed frames: the first of two fragments, the second of one.
DicomPixelData three_fragments() {
  DicomPixelData pixels;
  pixels.encapsulated.start = 100;
  pixels.encapsulated.frames_at = {0, 50};
  pixels.encapsulated.fragments = {{108, 10}, {126, 24}, {158, 8}};  // each behind its item's eight bytes
  return pixels;
}

DicomHeader compressed_file() {
  DicomHeader file;
  file.file = "enhanced.dcm";
  file.columns = file.rows = 4;
  file.bits_allocated = 16;
  file.encapsulated = true;
  return file;
}

TEST(SplitIntoFrames, SharesFragmentsOutByTheOffsetTable) {
  DicomFrameGroups groups;
  groups.frame_count = {2.0};
  const std::vector<DicomHeader> frames = split_into_frames(compressed_file(), groups, three_fragments());
  ASSERT_EQ(frames.size(), 2u);
  ASSERT_EQ(frames[0].pixels.size(), 2u);
  EXPECT_EQ(frames[0].pixels[1].offset, 126u);
  ASSERT_EQ(frames[1].pixels.size(), 1u);
  EXPECT_EQ(frames[1].pixels[0].offset, 158u);
  EXPECT_EQ(name_of(frames[1]), "enhanced.dcm, frame 2");
}

TEST(SplitIntoFrames, RejectsFragmentsThatCannotBeToldApart) {
  DicomFrameGroups groups;
  groups.frame_count = {2.0};
  const auto error = [&](const std::vector<std::uint32_t>& frames_at) {
    DicomPixelData pixels = three_fragments();
    pixels.encapsulated.frames_at = frames_at;
    return test::error_of([&] { split_into_frames(compressed_file(), groups, pixels); });
  };
  EXPECT_THAT(error({}), HasSubstr("expected 2 compressed frames, found 3 fragments and an offset table of 0"));
  EXPECT_THAT(error({50, 0}), HasSubstr("offset table"));
  EXPECT_THAT(error({10, 50}), HasSubstr("offset table"));
}

TEST(SplitIntoFrames, PrefersAFramesOwnGroupsToSharedOnesAndTheseToTheFiles) {
  DicomHeader file = compressed_file();
  file.encapsulated = false;
  file.rescale_slope = {1.0};
  file.rescale_intercept = {-1000.0};
  DicomFrameGroups groups;
  groups.frame_count = {2.0};
  groups.shared.resize(1);
  groups.shared[0].rescale_slope = {2.0};
  groups.shared[0].stack_id = "1";
  groups.per_frame.resize(2);
  groups.per_frame[1].rescale_slope = {3.0};
  DicomPixelData pixels;
  pixels.plain = {1000, 64};
  const std::vector<DicomHeader> frames = split_into_frames(file, groups, pixels);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_THAT(frames[0].rescale_slope, ElementsAre(2.0));
  EXPECT_THAT(frames[1].rescale_slope, ElementsAre(3.0));
  EXPECT_THAT(frames[1].rescale_intercept, ElementsAre(-1000.0));
  EXPECT_EQ(frames[1].stack_id, "1");
  EXPECT_EQ(frames[1].pixels[0].offset, 1032u);
  EXPECT_EQ(frames[1].pixels[0].length, 32u);
  groups.per_frame.resize(1);
  EXPECT_THAT(test::error_of([&] { split_into_frames(file, groups, pixels); }),
              HasSubstr("of 2 frames, found those of 1"));
}

}  // namespace
}  // namespace spinaltap
