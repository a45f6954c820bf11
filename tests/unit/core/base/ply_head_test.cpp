#include "core/base/ply_head.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/staged_output.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

TEST(PlyHead, ComesBackAsItWasWritten) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "a.ply";
  for (const PlyFormat format : {PlyFormat::ascii, PlyFormat::little_endian, PlyFormat::big_endian}) {
    PlyHead head{
        .format = format, .comments = {"two words", ""}, .elements = {{"vertex", 12'345'678'901}, {"face", 0}}};
    for (const PlyType type : {PlyType::int8, PlyType::uint8, PlyType::int16, PlyType::uint16, PlyType::int32,
                               PlyType::uint32, PlyType::float32, PlyType::float64}) {
      head.elements[0].properties.push_back({"p", type});
    }
    head.elements[1].properties.push_back({"vertex_indices", PlyType::int32, PlyType::uint8});
    write_whole_file(path, encode(head) + "body");
    FileReader file(path);
    const PlyHead read = read_ply_head(file);
    EXPECT_EQ(read.format, format);
    EXPECT_EQ(read.comments, head.comments);
    ASSERT_EQ(read.elements.size(), 2U);
    EXPECT_EQ(read.elements[0].count, 12'345'678'901U);
    EXPECT_EQ(read.elements[1].properties[0].count_type, PlyType::uint8);
    EXPECT_EQ(encode(read), encode(head));
    std::string_view body;
    ASSERT_TRUE(file.line(body));
    EXPECT_EQ(body, "body");
  }
}

}  // namespace
}  // namespace spinaltap
