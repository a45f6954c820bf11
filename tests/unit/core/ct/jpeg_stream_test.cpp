#include "core/ct/detail/jpeg_stream.h"

#include <gtest/gtest.h>

#include <string>

namespace spinaltap {
namespace {

std::string text(std::initializer_list<int> bytes) {
  std::string result;
  for (const int byte : bytes) result.push_back(static_cast<char>(byte));
  return result;
}

const std::string kStart = text({0xff, 0xd8});
const std::string kFrame = text({0xff, 0xc3, 0, 11, 12, 1, 44, 1, 144, 1, 1, 0x11, 0});
const std::string kTable = text({0xff, 0xc4, 0, 20, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 7});
const std::string kScan = text({0xff, 0xda, 0, 8, 1, 1, 0, 1, 0, 0});
const std::string kData = text({0x12, 0xff, 0x00, 0x34, 0xff, 0xd0, 0x56});
const std::string kEnd = text({0xff, 0xd9});

std::string plain_stream(const std::string& stream) {
  const auto bytes = plain_jpeg_stream(stream);
  return bytes ? std::string(bytes->begin(), bytes->end()) : "none";
}

TEST(PlainJpegStream, KeepsWhatDecodingNeedsAndNothingElse) {
  const std::string whole = kStart + kFrame + kTable + kScan + kData + kEnd;
  EXPECT_EQ(plain_stream(whole), whole);
  const std::string application = text({0xff, 0xe0, 0, 4, 9, 9});
  const std::string comment = text({0xff, 0xfe, 0, 3, 'x'});
  const std::string second_scan = kScan + kData;
  EXPECT_EQ(plain_stream(kStart + application + kFrame + comment + kTable + kScan + kData + second_scan + kEnd), whole);
  EXPECT_EQ(plain_stream(kStart + kFrame + text({0xff}) + kTable + kScan + kData),
            whole);  // fill byte; no end
}

TEST(PlainJpegStream, RejectsWhatIsOutOfPlace) {
  EXPECT_EQ(plain_stream(""), "none");
  EXPECT_EQ(plain_stream(kStart + "x" + kFrame + kTable + kScan + kData + kEnd), "none");
  EXPECT_EQ(plain_stream(kStart + kFrame + kFrame + kTable + kScan + kData + kEnd), "none");
  EXPECT_EQ(plain_stream(kStart + kTable + kScan + kData + kEnd), "none");
  EXPECT_EQ(plain_stream(kStart + kFrame + kTable), "none");
  EXPECT_EQ(plain_stream(kStart + kFrame + kTable.substr(0, 10)), "none");
  std::string three_codes_of_one_bit = kTable;
  three_codes_of_one_bit[5] = 3;
  EXPECT_EQ(plain_stream(kStart + kFrame + three_codes_of_one_bit + kScan + kData + kEnd), "none");
  std::string no_predictor = kScan;
  no_predictor[7] = 0;
  EXPECT_EQ(plain_stream(kStart + kFrame + kTable + no_predictor + kData + kEnd), "none");
}

}  // namespace
}  // namespace spinaltap
