#include "core/ct/detail/dicom_slice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/ct/detail/jpeg_stream.h"
#include "tests/support/error_of.h"
#include "tests/support/test_data.h"

namespace spinaltap {
namespace {

using test::error_of;
using testing::AllOf;
using testing::HasSubstr;

std::optional<CodestreamSize> size_of(const std::vector<int>& bytes) {
  std::vector<char> chars;
  for (const int byte : bytes) chars.push_back(static_cast<char>(byte));
  return codestream_size(chars);
}

TEST(CodestreamSize, ReadsJpegFramesBehindOtherSegments) {
  // Start, a comment of two bytes, then a lossless frame: 12 bits, 300 rows, 400 columns, one component.
  const auto size = size_of({0xff, 0xd8, 0xff, 0xfe, 0, 4, 7, 7, 0xff, 0xc3, 0, 11, 12, 1, 44, 1, 144, 1, 0, 0x11, 0});
  ASSERT_TRUE(size);
  EXPECT_EQ(size->columns, 400);
  EXPECT_EQ(size->rows, 300);
  EXPECT_EQ(size->components, 1);
  EXPECT_EQ(size->bits, 12);
}

TEST(CodestreamSize, FindsNoneInOtherBytes) {
  EXPECT_FALSE(size_of({}));
  EXPECT_FALSE(size_of({0xff, 0xd8, 0xff, 0xd9}));
  EXPECT_FALSE(size_of({0xff, 0xd8, 0xff, 0xda, 0, 8, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_FALSE(size_of({1, 2, 3, 4, 5, 6, 7, 8}));
}

TEST(DecodeDicomSlice, RejectsCompressedPixelsOfAnotherSize) {
  SPINALTAP_NEED_TEST_DATA(data, "thoracic_ct_j2k");
  const std::filesystem::path file = std::filesystem::directory_iterator(data / "dicom")->path();
  std::vector<DicomHeader> headers = read_dicom_headers(file);
  ASSERT_EQ(headers.size(), 1u);
  headers[0].rows = 100;
  std::vector<std::int16_t> hu(100 * 512);
  EXPECT_THAT(error_of([&] { decode_dicom_slice(headers[0], hu); }),
              AllOf(HasSubstr("expected compressed pixels of 512 x 100"), HasSubstr("found 512 x 512"),
                    HasSubstr(file.filename().string())));
}

}  // namespace
}  // namespace spinaltap
