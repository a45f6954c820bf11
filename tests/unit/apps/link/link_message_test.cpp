// Messages against OpenIGTLink's own classes, which know nothing of ours, and against what is no message.

#include "apps/link/link_message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <igtlPointMessage.h>
#include <igtlPolyDataMessage.h>
#include <igtlStatusMessage.h>
#include <igtlStringMessage.h>
#include <igtlTransformMessage.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "core/base/error.h"

namespace spinaltap {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct Read {
  std::vector<LinkMessage> messages;
  std::vector<LinkRejection> refusals;
  bool is_sound = true;
  bool is_within = false;
};

/// `piece` bytes at a time.
Read read_in_pieces(std::string_view bytes, std::size_t piece) {
  Read read;
  LinkReader reader;
  for (std::size_t at = 0; at < bytes.size() && read.is_sound; at += piece) {
    read.is_sound = reader.take(
        bytes.substr(at, piece), [&](LinkMessage&& message) { read.messages.push_back(std::move(message)); },
        [&](LinkRejection refusal) { read.refusals.push_back(refusal); });
  }
  read.is_within = reader.is_within();
  return read;
}

LinkTransform some_transform() {
  LinkTransform transform = LinkTransform::Identity();
  transform.linear() = Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  transform.translation() = Vec3(12.25, -80.5, 431.125);  // floats have these exactly
  return transform;
}

std::string a_transform(const std::string& device = "Tool", int version = 1) {
  return pack_message("TRANSFORM", device, transform_content(some_transform()), version, 77);
}

/// Fills a message of the library's own from bytes, as its receivers do.
template <class Pointer>
int unpack(const std::string& bytes, Pointer& message) {
  const igtl::MessageHeader::Pointer header = igtl::MessageHeader::New();
  header->InitPack();
  std::memcpy(header->GetPackPointer(), bytes.data(), static_cast<std::size_t>(header->GetPackSize()));
  header->Unpack();
  message->SetMessageHeader(header);
  message->AllocatePack();
  EXPECT_EQ(bytes.size(), static_cast<std::size_t>(message->GetPackSize()));
  std::memcpy(message->GetPackBodyPointer(), bytes.data() + header->GetPackSize(),
              static_cast<std::size_t>(message->GetPackBodySize()));
  return message->Unpack(1);
}

std::string packed(igtl::MessageBase& message) {
  message.Pack();
  return {static_cast<const char*>(message.GetPackPointer()), static_cast<std::size_t>(message.GetPackSize())};
}

TEST(LinkMessages, AreReadByOpenIGTLinksOwnClasses) {
  const igtl::TransformMessage::Pointer transform = igtl::TransformMessage::New();
  ASSERT_TRUE(unpack(a_transform("Bit"), transform) & igtl::MessageHeader::UNPACK_BODY);
  EXPECT_STREQ(transform->GetDeviceName(), "Bit");
  igtl::Matrix4x4 matrix;
  transform->GetMatrix(matrix);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      EXPECT_NEAR(static_cast<double>(matrix[row][column]), some_transform().matrix()(row, column), 1e-6);
    }
  }
  const igtl::StringMessage::Pointer text = igtl::StringMessage::New();
  ASSERT_TRUE(unpack(pack_message("STRING", "State", string_content("{\"depth_mm\":1}")), text) &
              igtl::MessageHeader::UNPACK_BODY);
  EXPECT_STREQ(text->GetString(), "{\"depth_mm\":1}");
  const igtl::StatusMessage::Pointer status = igtl::StatusMessage::New();
  ASSERT_TRUE(
      unpack(pack_message("STATUS", "SpinalTap", status_content(LinkStatusCode::time_out, "stale", "why")), status) &
      igtl::MessageHeader::UNPACK_BODY);
  EXPECT_EQ(status->GetCode(), igtl::StatusMessage::STATUS_TIME_OUT);
  EXPECT_STREQ(status->GetErrorName(), "stale");
  EXPECT_STREQ(status->GetStatusString(), "why");
  const igtl::PointMessage::Pointer points = igtl::PointMessage::New();
  const std::vector<LinkPoint> plan{{"Entry", "Plan", {1.0, 2.0, 3.5}, 1.5}, {"Target", "Plan", {-4.0, 5.0, 6.0}, 1.5}};
  ASSERT_TRUE(unpack(pack_message("POINT", "Plan", point_content(plan)), points) & igtl::MessageHeader::UNPACK_BODY);
  ASSERT_EQ(points->GetNumberOfPointElement(), 2);
  igtl::PointElement::Pointer target;
  points->GetPointElement(1, target);
  EXPECT_STREQ(target->GetName(), "Target");
  igtlFloat32 place[3];
  target->GetPosition(place);
  EXPECT_THAT(place, ElementsAre(-4.0F, 5.0F, 6.0F));
}

TEST(LinkMessages, GiveATetrahedronToOpenIGTLinksOwnClasses) {
  const std::vector<Eigen::Vector3f> vertices_mm{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  const igtl::PolyDataMessage::Pointer message = igtl::PolyDataMessage::New();
  ASSERT_TRUE(unpack(pack_message("POLYDATA", "Bone", polydata_content(vertices_mm, triangles)), message) &
              igtl::MessageHeader::UNPACK_BODY);
  ASSERT_EQ(message->GetPoints()->GetNumberOfPoints(), 4);
  ASSERT_EQ(message->GetPolygons()->GetNumberOfCells(), 4U);
  igtlFloat32 point[3];
  message->GetPoints()->GetPoint(2, point);
  EXPECT_THAT(point, ElementsAre(0.0F, 1.0F, 0.0F));
  std::list<igtlUint32> cell;
  message->GetPolygons()->GetCell(3, cell);
  EXPECT_THAT(cell, ElementsAre(2U, 0U, 3U));
}

TEST(LinkMessages, OfOpenIGTLinksOwnClassesAreReadInAnyPieces) {
  const igtl::TransformMessage::Pointer transform = igtl::TransformMessage::New();
  igtl::Matrix4x4 matrix;
  igtl::IdentityMatrix(matrix);
  matrix[0][0] = 0.0F, matrix[0][1] = -1.0F, matrix[1][0] = 1.0F, matrix[1][1] = 0.0F;  // 90 degrees about z
  matrix[0][3] = 5.0F, matrix[1][3] = 6.0F, matrix[2][3] = 7.0F;
  transform->SetMatrix(matrix);
  transform->SetDeviceName("Tool");
  const igtl::StringMessage::Pointer text = igtl::StringMessage::New();
  text->SetDeviceName("Command");
  text->SetString("SPINDLE OFF");
  const std::string bytes = packed(*transform) + packed(*text);
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, std::size_t{58}, bytes.size()}) {
    const Read read = read_in_pieces(bytes, piece);
    ASSERT_EQ(read.messages.size(), 2U) << piece;
    EXPECT_THAT(read.refusals, IsEmpty());
    EXPECT_FALSE(read.is_within);
    EXPECT_EQ(read.messages[0].device, "Tool");
    const std::optional<LinkTransform> got = transform_of(read.messages[0].content);
    ASSERT_TRUE(got);
    EXPECT_LT((*got * Vec3::UnitX() - Vec3(5.0, 7.0, 7.0)).norm(), 1e-9);
    EXPECT_EQ(string_of(read.messages[1].content), "SPINDLE OFF");
  }
}

TEST(LinkMessages, OfVersion3HaveMetadataWhichSayWhetherATransformIsValid) {
  const std::map<std::string, std::string> seen{{"ToolToTrackerTransformStatus", "OK"}, {"note", "anything"}};
  const std::map<std::string, std::string> unseen{{"ToolToTrackerTransformStatus", "INVALID"}};
  const Read read = read_in_pieces(
      pack_message("TRANSFORM", "Tool", transform_content(some_transform()), 2, 5, seen) +
          pack_message("TRANSFORM", "Tool", transform_content(some_transform()), 2, 6, unseen) +
          pack_message("TRANSFORM", "Tool", transform_content(some_transform()), 2, 6, {{"TransformValid", "false"}}),
      11);
  ASSERT_EQ(read.messages.size(), 3U);
  EXPECT_EQ(read.messages[0].metadata, seen);
  EXPECT_EQ(read.messages[0].time_stamp, 5U);
  EXPECT_EQ(read.messages[0].content, transform_content(some_transform()));
  EXPECT_TRUE(is_said_valid(read.messages[0]));
  EXPECT_FALSE(is_said_valid(read.messages[1]));
  EXPECT_FALSE(is_said_valid(read.messages[2]));
}

TEST(LinkMessages, HaveTheChecksumOfECMA182) {
  // The check value of CRC-64/ECMA-182 for "123456789".
  const std::string message = pack_message("STRING", "A", "123456789");
  EXPECT_EQ(message.substr(50, 8), (std::string{'\x6C', '\x40', '\xDF', '\x5F', '\x0B', '\x49', '\x73', '\x47'}));
}

TEST(LinkReader, PassesOverWhatIsDamagedAndGoesOn) {
  std::string damaged = a_transform();
  damaged.back() = static_cast<char>(damaged.back() ^ 1);
  const Read read = read_in_pieces(damaged + a_transform("Reference"), 10);
  EXPECT_THAT(read.refusals, ElementsAre(LinkRejection::checksum));
  ASSERT_EQ(read.messages.size(), 1U);
  EXPECT_EQ(read.messages[0].device, "Reference");
}

TEST(LinkReader, PassesOverTypesThatNobodyWantsWithoutKeepingThem) {
  const std::string image = pack_message("IMAGE", "US", std::string(3'000'000, 'x'));
  const Read read = read_in_pieces(image + a_transform(), 65536);
  EXPECT_THAT(read.refusals, ElementsAre(LinkRejection::type));
  ASSERT_EQ(read.messages.size(), 1U);
}

TEST(LinkReader, RejectsABodyThatIsTooLargeForItsTypeBeforeItComes) {
  const std::string text = pack_message("STRING", "Command", std::string(LinkReader::kMaxBody + 1, 'x'));
  const Read at_once = read_in_pieces(text.substr(0, 58), 58);
  EXPECT_THAT(at_once.refusals, ElementsAre(LinkRejection::size));
  const Read read = read_in_pieces(text + a_transform(), 4096);
  EXPECT_EQ(read.messages.size(), 1U);
}

TEST(LinkReader, LosesAStreamOfWhatIsNoHeader) {
  std::string huge = a_transform();
  for (std::size_t at = 42; at < 50; ++at) huge[at] = '\xFF';
  std::string other_version = a_transform();
  other_version[1] = '\x09';
  for (const std::string& bytes :
       {std::string("GET / HTTP/1.1\r\nHost: here\r\nUser-Agent: something that looks\r\n\r\n"), std::string(58, '\0'),
        std::string(58, '\xFF'), huge, other_version}) {
    const Read read = read_in_pieces(bytes + a_transform(), 13);
    EXPECT_FALSE(read.is_sound);
    EXPECT_THAT(read.refusals, ElementsAre(LinkRejection::header));
    EXPECT_THAT(read.messages, IsEmpty());
  }
}

TEST(LinkReader, RejectsExtendedHeadersWhosePartsLeadOutOfTheBody) {
  const std::map<std::string, std::string> metadata{{"key", "value"}};
  const std::string whole = pack_message("STRING", "Command", string_content("END"), 2, 0, metadata);
  const std::string body = whole.substr(58);
  ASSERT_EQ(read_in_pieces(whole, 9).messages.size(), 1U);
  std::size_t rejected = 0;
  // Sizes of the extended header, of the metadata's head and texts, their count, and the sizes of a key and a value.
  const std::size_t head = 12 + string_content("END").size();
  for (const std::size_t at : {std::size_t{0}, std::size_t{2}, std::size_t{4}, head, head + 2, head + 6}) {
    std::string changed = body;
    changed[at] = '\x7F';
    const Read read = read_in_pieces(pack_message("STRING", "Command", changed).replace(1, 1, "\x02"), 9);
    EXPECT_THAT(read.messages, IsEmpty()) << at;
    EXPECT_THAT(read.refusals, ElementsAre(LinkRejection::content)) << at;
    ++rejected;
  }
  EXPECT_EQ(rejected, 6U);
}

TEST(TransformOf, RejectsWhatIsNoPlaceOfATool) {
  const auto changed = [](int row, int column, double value) {
    LinkTransform transform = some_transform();
    transform.matrix()(row, column) = value;
    return transform_of(transform_content(transform));
  };
  EXPECT_TRUE(transform_of(transform_content(some_transform())));
  EXPECT_FALSE(changed(0, 0, std::nan("")));
  EXPECT_FALSE(changed(1, 3, std::numeric_limits<double>::infinity()));
  EXPECT_FALSE(changed(2, 3, 1e6));
  EXPECT_FALSE(changed(0, 0, 2.0));
  LinkTransform mirrored = some_transform();
  mirrored.linear() *= -1.0;
  EXPECT_FALSE(transform_of(transform_content(mirrored)));
  EXPECT_FALSE(transform_of(std::string(48, '\0')));
  EXPECT_FALSE(transform_of(transform_content(some_transform()) + "x"));
  EXPECT_FALSE(transform_of(""));
}

TEST(StringOf, RejectsALengthThatLeadsOutOfTheBody) {
  EXPECT_EQ(string_of(string_content("")), "");
  EXPECT_FALSE(string_of(string_content("abc").substr(0, 5)));
  EXPECT_FALSE(string_of("abc"));
  EXPECT_THROW(string_content(std::string(65536, 'x')), Error);
}

}  // namespace
}  // namespace spinaltap
