#include "core/base/file_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/base/gzip.h"
#include "core/base/staged_output.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::error_of;
using testing::ElementsAre;
using testing::HasSubstr;

class FileReaders : public testing::Test {
 protected:
  FileReader over(const std::string& name, const std::string& bytes) {
    write_whole_file(folder_.path() / name, bytes);
    return FileReader(folder_.path() / name);
  }
  static std::vector<std::string> lines_of(FileReader reader) {
    std::vector<std::string> lines;
    for (std::string_view line; reader.line(line);) lines.emplace_back(line);
    return lines;
  }

  test::TemporaryFolder folder_;
};

TEST_F(FileReaders, GiveLinesWithoutTheirEnds) {
  EXPECT_THAT(lines_of(over("a", "one\r\n\ntwo\nthree")), ElementsAre("one", "", "two", "three"));
  EXPECT_THAT(lines_of(over("a", "")), ElementsAre());
  EXPECT_THAT(lines_of(over("a", "\n")), ElementsAre(""));
}

TEST_F(FileReaders, ReadPackedPiecesOneAfterTheOther) {
  // As bgzip and `cat a.gz b.gz` make them.
  EXPECT_THAT(lines_of(over("a.gz", gzip("one\ntw") + gzip("o\nthree\n"))), ElementsAre("one", "two", "three"));
}

TEST_F(FileReaders, MixLinesAndBytesAndCountWhatIsLeft) {
  std::string content = "head\n";
  for (int i = 0; i < 5 << 20; ++i) content += static_cast<char>('a' + i % 23);
  FileReader reader = over("a", content);
  std::string_view view;
  ASSERT_TRUE(reader.line(view));
  EXPECT_EQ(view, "head");
  EXPECT_EQ(reader.max_bytes_left(), std::uint64_t{5} << 20);
  ASSERT_TRUE(reader.bytes(1 << 20, view));
  EXPECT_EQ(view, std::string_view(content).substr(5, 1 << 20));
  ASSERT_TRUE(reader.skip((3 << 20) + 7));
  ASSERT_TRUE(reader.bytes(1000, view));
  EXPECT_EQ(view, std::string_view(content).substr(5 + (4 << 20) + 7, 1000));
  EXPECT_EQ(reader.max_bytes_left(), (1U << 20) - 1007U);
  EXPECT_FALSE(reader.bytes(1 << 20, view));
  EXPECT_TRUE(reader.bytes((1 << 20) - 1007, view));
  EXPECT_FALSE(reader.bytes(1, view));
  EXPECT_FALSE(reader.skip(1));
}

TEST_F(FileReaders, RejectLinesAndPiecesThatAreTooLong) {
  const std::string name = (folder_.path() / "a").string();
  FileReader reader = over("a", std::string(3 << 20, 'x'));
  std::string_view view;
  EXPECT_THAT(error_of([&] { reader.line(view); }), HasSubstr("found a longer one in " + name));
  EXPECT_THAT(error_of([&] { reader.bytes(3 << 20, view); }), HasSubstr("pieces of at most 1048576 bytes"));
}

}  // namespace
}  // namespace spinaltap
