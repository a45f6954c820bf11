#include "core/ct/detail/dicom_rle.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace spinaltap {
namespace {

/// A stream of two segments.
std::string stream_of(const std::string& high, const std::string& low) {
  std::string stream(64, '\0');
  stream[0] = 2;
  stream[4] = 64;
  stream[8] = static_cast<char>(64 + high.size());
  return stream + high + low;
}

TEST(DecodeDicomRle, ReadsRunsAndLiteralsOfBothBytes) {
  const std::string high("\xfd\x01\x80", 3);         // four times 1; then a byte that means nothing
  const std::string low("\x01\x07\x08\xff\x09", 5);  // 7, 8 as they are, then 9 twice
  std::vector<char> values(8);
  ASSERT_TRUE(decode_dicom_rle(stream_of(high, low), 2, values));
  EXPECT_EQ(std::string(values.begin(), values.end()), std::string("\x07\x01\x08\x01\x09\x01\x09\x01", 8));
}

TEST(DecodeDicomRle, RejectsStreamsThatEndEarlyOrLie) {
  std::vector<char> values(8);
  const std::string run("\xfd\x01", 2);
  EXPECT_TRUE(decode_dicom_rle(stream_of(run, run), 2, values));
  EXPECT_FALSE(decode_dicom_rle(stream_of(run, run.substr(0, 1)), 2, values));
  EXPECT_FALSE(decode_dicom_rle(stream_of(run, std::string("\x03\x01\x02", 3)), 2, values));
  EXPECT_FALSE(decode_dicom_rle(stream_of(run, run), 1, values));
  EXPECT_FALSE(decode_dicom_rle(std::string(10, '\0'), 2, values));
  std::string beyond = stream_of(run, run);
  beyond[9] = 1;  // the second segment begins beyond the end
  EXPECT_FALSE(decode_dicom_rle(beyond, 2, values));
}

}  // namespace
}  // namespace spinaltap
