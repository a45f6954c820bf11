#include "core/rbf/value_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/base/gzip.h"
#include "core/base/staged_output.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::error_of;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class ValueFile : public testing::Test {
 protected:
  std::filesystem::path put(const std::string& name, const std::string& bytes) {
    write_whole_file(folder_.path() / name, bytes);
    return folder_.path() / name;
  }
  RbfValues values(const std::string& name, const std::string& bytes) { return read_values(put(name, bytes)); }

  /// The error of a file, which is one line with its name.
  std::string error(const std::string& name, const std::string& bytes) {
    const std::string message = error_of([&] { values(name, bytes); });
    EXPECT_THAT(message, AllOf(HasSubstr(name), Not(HasSubstr("\n")))) << bytes;
    return message;
  }

  test::TemporaryFolder folder_;
};

/// A number's bytes in either order.
template <class Number>
std::string raw(Number number, bool is_big_endian) {
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  if (is_big_endian) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

TEST_F(ValueFile, ReadsFourOrFiveColumnsWithoutAHeader) {
  const RbfValues four = values("a.csv", "1,2,3,-0.5\n4.5e1,-5,+6, 0.25 \r\n\n");
  EXPECT_THAT(four.points_mm, ElementsAre(Vec3(1, 2, 3), Vec3(45, -5, 6)));
  EXPECT_THAT(four.values_mm, ElementsAre(-0.5, 0.25));
  EXPECT_THAT(four.error_bars_mm, IsEmpty());
  const RbfValues five = values("a.csv", "1,2,3,4,0.1\n5,6,7,8,0");  // no newline at the end
  EXPECT_THAT(five.values_mm, ElementsAre(4, 8));
  EXPECT_THAT(five.error_bars_mm, ElementsAre(0.1, 0.0));
}

TEST_F(ValueFile, FindsNamedColumnsInAnyOrderAndLeavesOutOthers) {
  const RbfValues read = values("A.CSV",
                                "\xEF\xBB\xBF\"note\", Value,z,y,x,error_bar,id\r\n"
                                "\"left, upper\",0.5,3,2,1,0.01,a\r\n"
                                ",-0.5,6,5,4,0.02,\r\n");
  EXPECT_THAT(read.points_mm, ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
  EXPECT_THAT(read.values_mm, ElementsAre(0.5, -0.5));
  EXPECT_THAT(read.error_bars_mm, ElementsAre(0.01, 0.02));
}

TEST_F(ValueFile, GivesWrittenDoublesBackExactly) {
  const RbfValues read = values("a.csv", "0.1,-1.7976931348623157e308,5e-324,0.30000000000000004\n");
  EXPECT_EQ(read.points_mm[0], Vec3(0.1, -std::numeric_limits<double>::max(), 5e-324));
  EXPECT_EQ(read.values_mm[0], 0.1 + 0.2);
}

TEST_F(ValueFile, ReadsGzippedLinesAcrossPieces) {
  // About 4 MB, more than the reader holds at once.
  std::string text = "x,y,z,value\n";
  constexpr int kCount = 100'000;
  for (int i = 0; i < kCount; ++i) {
    text += std::to_string(i) + "," + std::to_string(0.5 * i) + ",-7.125," + std::to_string(i % 97) + "\n";
  }
  for (const auto& [name, bytes] : {std::pair{"a.csv", text}, std::pair{"a.csv.gz", gzip(text)}}) {
    const RbfValues read = values(name, bytes);
    ASSERT_EQ(read.points_mm.size(), std::size_t{kCount});
    for (int i = 0; i < kCount; ++i) {
      ASSERT_EQ(read.points_mm[std::size_t(i)], Vec3(i, 0.5 * i, -7.125));
      ASSERT_EQ(read.values_mm[std::size_t(i)], i % 97);
    }
  }
}

TEST_F(ValueFile, ReadsPositionsOfFilesWithAndWithoutMore) {
  EXPECT_THAT(read_positions(put("a.csv", "1,2,3\n")), ElementsAre(Vec3(1, 2, 3)));
  EXPECT_THAT(read_positions(put("a.csv", "1,2,3,nan,text\n4,5,6,,\n")), ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
  EXPECT_THAT(read_positions(put("a.csv", "z,value,x,y\n3,a,1,2\n")), ElementsAre(Vec3(1, 2, 3)));
  EXPECT_THAT(error_of([&] { read_positions(put("a.csv", "1,2\n")); }), HasSubstr("at least 3 numbers"));
}

TEST_F(ValueFile, NamesFileAndLineOfWhatIsWrongInACsv) {
  EXPECT_THAT(error("a.csv", "1,2,3,4\n\n1,2,zwei,4\n"),
              AllOf(HasSubstr("expected a number as z, found \"zwei\""), HasSubstr("a.csv, line 3")));
  EXPECT_THAT(error("a.csv", "1,2,3,4\n1,2,3\n"), HasSubstr("expected 4 columns, found 3 in"));
  EXPECT_THAT(error("a.csv", "1,2,3,4\n1,2,3,4,5\n"), HasSubstr("expected 4 columns, found 5 in"));
  EXPECT_THAT(error("a.csv", "1,2,3,4\n1,2,3,nan\n"), HasSubstr("expected a finite value, found nan in"));
  EXPECT_THAT(error("a.csv", "1,-inf,3,4\n"), HasSubstr("expected a finite y, found -inf in"));
  EXPECT_THAT(error("a.csv", "1,2,3,1e999\n"), HasSubstr("found \"1e999\""));
  EXPECT_THAT(error("a.csv", "1,2,3,4,-0.1\n"), HasSubstr("expected an error_bar of 0 mm or more, found -0.1"));
  EXPECT_THAT(error("a.csv", "1,2,3,4,nan\n"), HasSubstr("expected a finite error_bar"));
  EXPECT_THAT(error("a.csv", "x,y,z\n1,2,3\n"), HasSubstr("a header with the columns x, y, z, value, found \"x,y,z\""));
  EXPECT_THAT(error("a.csv", "x,y,z,value,x\n"), HasSubstr("expected one column x, found two"));
  EXPECT_THAT(error("a.csv", "1 2 3 4\n"), HasSubstr("found \"1 2 3 4\""));
  EXPECT_THAT(error("a.csv", "1,2,3\n"), HasSubstr("expected 4 or 5 numbers with commas between them"));
  EXPECT_THAT(error("a.csv", "1,2,3,4,5,6\n"), HasSubstr("4 or 5 numbers"));
  EXPECT_THAT(error("a.csv", "x,y,z,value\n"), HasSubstr("expected points, found none"));
  EXPECT_THAT(error("a.csv", ""), HasSubstr("expected points, found none"));
  EXPECT_THAT(error("a.csv", std::string(3 << 20, '7')), HasSubstr("expected lines of at most 1048576 bytes"));
  EXPECT_THAT(error("a.csv", std::string("\0\1\xff,2\n", 6)), HasSubstr("found \"???,2\""));
  EXPECT_THAT(error("a.xyz", "1 2 3 4\n"), HasSubstr("ends in .csv, .csv.gz or .ply"));
  EXPECT_THAT(error_of([&] { read_values(folder_.path() / "none.csv"); }), HasSubstr("no such file"));
  EXPECT_THAT(error_of([&] { read_values(folder_.path()); }), HasSubstr("ends in"));
}

TEST_F(ValueFile, RejectsGzipThatIsNoneOrCutShort) {
  std::string text;
  for (int i = 0; i < 5000; ++i) text += std::to_string(i * 7919 % 5003) + ",2,3,4\n";
  const std::string packed = gzip(text);
  EXPECT_THAT(error("a.csv.gz", text), HasSubstr("expected gzip data, found other"));
  EXPECT_THAT(error("a.csv.gz", ""), HasSubstr("expected gzip data"));
  EXPECT_THAT(error("a.csv", packed), HasSubstr("expected a name that ends in .gz, found gzip data"));
  for (const std::size_t left : {packed.size() - 1, packed.size() - 8, packed.size() / 2, std::size_t{12}}) {
    EXPECT_THAT(error("a.csv.gz", packed.substr(0, left)), HasSubstr("damaged one or one cut short")) << left;
  }
  std::string damaged = packed;
  damaged[damaged.size() / 2] ^= 0x55;
  EXPECT_NE(error("a.csv.gz", damaged), "");
  damaged = packed;
  damaged[damaged.size() - 6] ^= 1;  // its checksum
  EXPECT_THAT(error("a.csv.gz", damaged), HasSubstr("damaged"));
}

/// As numpy.savetxt and plyfile's ascii output write them.
TEST_F(ValueFile, ReadsAnAsciiPlyWrittenByHand) {
  const RbfValues read = values("a.ply",
                                "ply\nformat ascii 1.0\ncomment by hand\nobj_info none\n"
                                "element camera 2\nproperty list uchar int views\nproperty float f\n"
                                "element vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
                                "property uchar red\nproperty list uchar float near\nproperty float value\n"
                                "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                                "2 7 8 0.5\n0 1.5\n"
                                "1.000000000000000000e+00 2 3 255 0 -0.5\n"
                                "4 5 6 0 3 0.1 0.2 0.3 0\n"
                                "  7 8\t9 1 1 5 1e-3 \n"
                                "3 0 1 2\n");
  EXPECT_THAT(read.points_mm, ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6), Vec3(7, 8, 9)));
  EXPECT_THAT(read.values_mm, ElementsAre(-0.5, 0.0, 1e-3));
  EXPECT_THAT(read.error_bars_mm, IsEmpty());
}

TEST_F(ValueFile, ReadsBinaryPlyOfEitherByteOrder) {
  for (const bool big : {false, true}) {
    std::string bytes = std::string("ply\r\nformat binary_") + (big ? "big" : "little") +
                        "_endian 1.0\r\n"
                        "element plane 2\nproperty int16 n\n"
                        "element camera 2\nproperty list uint16 float64 views\nproperty int8 f\n"
                        "element vertex 2\nproperty int value\nproperty ushort z\nproperty list uchar short near\n"
                        "property float y\nproperty double x\nproperty float error_bar\nproperty char c\n"
                        "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    bytes += raw<std::int16_t>(1, big) + raw<std::int16_t>(2, big);
    bytes += raw<std::uint16_t>(2, big) + raw(0.5, big) + raw(0.25, big) + '\1' + raw<std::uint16_t>(0, big) + '\2';
    bytes += raw<std::int32_t>(-3, big) + raw<std::uint16_t>(40000, big) + '\1' + raw<std::int16_t>(9, big) +
             raw(2.5F, big) + raw(0.1, big) + raw(0.5F, big) + '\0';
    bytes += raw<std::int32_t>(70000, big) + raw<std::uint16_t>(1, big) + '\0' + raw(-2.5F, big) + raw(1e300, big) +
             raw(0.0F, big) + '\0';
    bytes += '\3' + raw<std::int32_t>(0, big) + raw<std::int32_t>(1, big) + raw<std::int32_t>(1, big);
    const RbfValues read = values("a.ply", bytes);
    EXPECT_THAT(read.points_mm, ElementsAre(Vec3(0.1, 2.5, 40000), Vec3(1e300, -2.5, 1)));
    EXPECT_THAT(read.values_mm, ElementsAre(-3, 70000));
    EXPECT_THAT(read.error_bars_mm, ElementsAre(0.5, 0.0));
    EXPECT_THAT(read_positions(folder_.path() / "a.ply"), read.points_mm);
  }
}

/// An ascii PLY with x, y, z, value and these lines.
std::string ascii(const std::string& count, const std::string& lines) {
  return "ply\nformat ascii 1.0\nelement vertex " + count +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty float value\nend_header\n" + lines;
}

TEST_F(ValueFile, NamesFileAndVertexOfWhatIsWrongInAPly) {
  EXPECT_THAT(error("a.ply", ascii("2", "1 2 3 4\n1 2 three 4\n")),
              AllOf(HasSubstr("expected a number, found \"three\""), HasSubstr("a.ply, vertex 2")));
  EXPECT_THAT(error("a.ply", ascii("2", "1 2 3 4\n1 2 3.0\n")), HasSubstr("expected 4 properties, found fewer"));
  EXPECT_THAT(error("a.ply", ascii("2", "1 2 3 4 5\n1 2 3 4\n")), HasSubstr("found more in"));
  EXPECT_THAT(error("a.ply", ascii("2", "1 2 3 4.00000000000\n")), HasSubstr("found 1 (cut short?)"));
  EXPECT_THAT(error("a.ply", ascii("1", "1 2 nan 4\n")), HasSubstr("expected a finite z, found nan"));
  EXPECT_THAT(error("a.ply", ascii("0", "")), HasSubstr("expected points, found none"));
  EXPECT_THAT(error("a.ply", ascii("-1", "")), HasSubstr("found \"element vertex -1\" in the head"));
  EXPECT_THAT(error("a.ply", ascii("1", "").replace(4, 12, "format yaml")), HasSubstr("expected PLY format ascii"));
  EXPECT_THAT(error("a.ply", "ply\nelement vertex 1\nend_header\n"), HasSubstr("expected a PLY format"));
  EXPECT_THAT(error("a.ply", "ply\nformat ascii 1.0\nelement face 0\nend_header\n"), HasSubstr("element vertex"));
  EXPECT_THAT(error("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
              HasSubstr("expected vertices with the properties x, y, z, value, found none named y"));
  EXPECT_THAT(error("a.ply", "ply\nformat ascii 1.0\nproperty float x\n"), HasSubstr("before its properties"));
  EXPECT_THAT(error("a.ply", "ply\nformat ascii 1.0\nelement v 1\nproperty real x\n"), HasSubstr("a PLY type"));
  EXPECT_THAT(error("a.ply", "ply\nformat ascii 1.0\nelement v 1\nproperty list float int x\n"),
              HasSubstr("a whole list count"));
  EXPECT_THAT(error("a.ply", "ply\nformat ascii 1.0\n"), HasSubstr("cut short?"));
  EXPECT_THAT(error("a.ply", "1,2,3,4\n"), HasSubstr("expected a PLY file"));
  EXPECT_THAT(error("a.ply", gzip("ply\n")), HasSubstr("gzip"));
}

TEST_F(ValueFile, BelievesNoCountOfAPly) {
  for (const char* count : {"3", "99999999999", "18446744073709551615"}) {
    EXPECT_THAT(error("a.ply", ascii(count, "1 2 3 4\n1 2 3 4\n")), HasSubstr(std::string("expected ") + count));
  }
  EXPECT_THAT(error("a.ply", ascii("18446744073709551616", "1 2 3 4\n")), HasSubstr("name and count"));
  const std::string head =
      "ply\nformat binary_little_endian 1.0\nelement strip 1\nproperty list uint uint i\n"
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float value\nend_header\n";
  EXPECT_THAT(error("a.ply", head + std::string(4, '\xff') + std::string(16, '\0')),
              HasSubstr("expected a list that fits in the file, found one of 4.29497e+09"));
  EXPECT_THAT(error("a.ply", head + std::string(4, '\0') + std::string(15, '\0')), HasSubstr("cut short?"));
  EXPECT_EQ(values("a.ply", head + std::string(20, '\0')).points_mm.size(), 1U);
}

}  // namespace
}  // namespace spinaltap
