#include "apps/link/link_message.h"

#include <igtl_header.h>
#include <igtl_point.h>
#include <igtl_polydata.h>
#include <igtl_string.h>
#include <igtl_transform.h>
#include <igtl_util.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "core/base/error.h"
#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

constexpr std::size_t kHeaderSize = IGTL_HEADER_SIZE;
constexpr std::size_t kExtendedSize = 12;
constexpr std::size_t kStatusHeadSize = 30;  ///< code, sub-code and a name of 20 letters

// The numbers of the wire are big-endian and lie anywhere.
template <class Number>
Number number_at(std::string_view bytes, std::size_t at) {
  Number number = 0;
  for (std::size_t n = 0; n < sizeof(Number); ++n) {
    number =
        static_cast<Number>((static_cast<std::uint64_t>(number) << 8U) | static_cast<unsigned char>(bytes[at + n]));
  }
  return number;
}

template <class Number>
void append(Number number, std::string& bytes) {
  for (std::size_t n = sizeof(Number); n-- > 0;) {
    bytes.push_back(static_cast<char>((static_cast<std::uint64_t>(number) >> (8 * n)) & 0xFFU));
  }
}

std::uint64_t checksum_of(std::string_view body) {
  std::string bytes(body);  // the library's function takes them as its own
  return crc64(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), 0);
}

/// A name in a field that it need not fill; nothing where it holds what no name has.
std::optional<std::string> name_in(std::string_view field) {
  const std::string_view name = field.substr(0, field.find('\0'));
  const bool is_plain =
      std::all_of(name.begin(), name.end(), [](char letter) { return letter >= ' ' && letter <= '~'; });
  return is_plain ? std::optional<std::string>(name) : std::nullopt;
}

bool is_wanted(std::string_view type) {
  constexpr std::array<std::string_view, 7> kTypes{"TRANSFORM", "STRING",       "STATUS",     "GET_STATUS",
                                                   "GET_POINT", "GET_POLYDATA", "GET_CAPABIL"};
  return std::find(kTypes.begin(), kTypes.end(), type) != kTypes.end();
}

/// The metadata behind the content; false where a size leads out of them.
bool read_metadata(std::string_view head, std::string_view texts, std::map<std::string, std::string>& metadata) {
  constexpr std::size_t kEntry = 8;
  if (head.empty()) return true;
  if (head.size() < 2) return false;
  const std::size_t count = number_at<std::uint16_t>(head, 0);
  if (head.size() < 2 + count * kEntry) return false;
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t key = number_at<std::uint16_t>(head, 2 + n * kEntry);
    const std::size_t value = number_at<std::uint32_t>(head, 2 + n * kEntry + 4);
    if (key > texts.size() || value > texts.size() - key) return false;
    metadata[std::string(texts.substr(0, key))] = std::string(texts.substr(key, value));
    texts.remove_prefix(key + value);
  }
  return true;
}

/// Takes a body apart; false where its parts do not fit into it.
bool read_body(std::string_view body, LinkMessage& message) {
  // Some senders name version 2 and know no extended header.
  const bool is_plain_transform = message.type == "TRANSFORM" && body.size() == IGTL_TRANSFORM_SIZE;
  if (message.header_version < 2 || is_plain_transform || body.empty()) {
    message.content = std::string(body);
    return true;
  }
  if (body.size() < kExtendedSize) return false;
  const std::size_t extended = number_at<std::uint16_t>(body, 0);
  const std::size_t metadata_head = number_at<std::uint16_t>(body, 2);
  const std::size_t metadata_texts = number_at<std::uint32_t>(body, 4);
  if (extended < kExtendedSize || extended > body.size()) return false;
  const std::size_t rest = body.size() - extended;
  if (metadata_head > rest || metadata_texts > rest - metadata_head) return false;
  const std::size_t content = rest - metadata_head - metadata_texts;
  message.content = std::string(body.substr(extended, content));
  return read_metadata(body.substr(extended + content, metadata_head), body.substr(body.size() - metadata_texts),
                       message.metadata);
}

void append_field(std::string_view text, std::size_t size, std::string& bytes) {
  const std::string_view cut = text.substr(0, size - 1);
  bytes += cut;
  bytes.append(size - cut.size(), '\0');
}

}  // namespace

std::string_view name_of(LinkRejection refusal) {
  constexpr std::array<std::string_view, kLinkRejections> kNames{"header", "size",    "checksum",      "content",
                                                                 "type",   "device",  "not in charge", "command",
                                                                 "half",   "hanging", "too many"};
  return kNames.at(static_cast<std::size_t>(refusal));
}

bool LinkReader::take(std::string_view bytes, const Sink& sink, const RejectionSink& refused) {
  while (!bytes.empty()) {
    if (skip_ > 0) {
      const std::size_t passed = static_cast<std::size_t>(std::min<std::uint64_t>(skip_, bytes.size()));
      skip_ -= passed;
      bytes.remove_prefix(passed);
      continue;
    }
    const std::size_t needed = kHeaderSize + (has_header_ ? body_ : 0) - buffer_.size();
    const std::size_t got = std::min(needed, bytes.size());
    buffer_ += bytes.substr(0, got);
    bytes.remove_prefix(got);
    if (got < needed) return true;
    if (!has_header_ && !begin(refused)) return false;
    if (has_header_ && buffer_.size() == kHeaderSize + body_) end(sink, refused);
  }
  return true;
}

/// With a whole header in the buffer.
bool LinkReader::begin(const RejectionSink& refused) {
  const int version = number_at<std::uint16_t>(buffer_, 0);
  const std::optional<std::string> type = name_in(std::string_view(buffer_).substr(2, IGTL_HEADER_TYPE_SIZE));
  const std::optional<std::string> device =
      name_in(std::string_view(buffer_).substr(2 + IGTL_HEADER_TYPE_SIZE, IGTL_HEADER_NAME_SIZE));
  const auto size = number_at<std::uint64_t>(buffer_, 42);
  if (version < 1 || version > 3 || !type || type->empty() || !device || size > kMaxPassedOver) {
    refused(LinkRejection::header);
    return false;
  }
  const bool wants = is_wanted(*type);
  if (wants && size <= kMaxBody) {
    has_header_ = true;
    body_ = static_cast<std::size_t>(size);
    return true;
  }
  refused(wants ? LinkRejection::size : LinkRejection::type);
  skip_ = size;
  buffer_.clear();
  return true;
}

/// With a whole message in the buffer.
void LinkReader::end(const Sink& sink, const RejectionSink& refused) {
  const std::string_view bytes = buffer_;
  const std::string_view body = bytes.substr(kHeaderSize);
  LinkMessage message;
  message.header_version = number_at<std::uint16_t>(bytes, 0);
  message.type = *name_in(bytes.substr(2, IGTL_HEADER_TYPE_SIZE));
  message.device = *name_in(bytes.substr(2 + IGTL_HEADER_TYPE_SIZE, IGTL_HEADER_NAME_SIZE));
  message.time_stamp = number_at<std::uint64_t>(bytes, 34);
  const auto checksum = number_at<std::uint64_t>(bytes, 50);
  // A body of nothing has the checksum 0, or none.
  const bool is_right = body.empty() || checksum == checksum_of(body);
  const bool is_whole = is_right && read_body(body, message);
  buffer_.clear();
  has_header_ = false;
  body_ = 0;
  if (is_whole) {
    sink(std::move(message));
  } else {
    refused(is_right ? LinkRejection::content : LinkRejection::checksum);
  }
}

std::string pack_message(std::string_view type, std::string_view device, std::string_view content, int header_version,
                         std::uint64_t time_stamp, const std::map<std::string, std::string>& metadata) {
  std::string body;
  if (header_version >= 2) {
    std::string head, texts;
    append(static_cast<std::uint16_t>(metadata.size()), head);
    for (const auto& [key, value] : metadata) {
      append(static_cast<std::uint16_t>(key.size()), head);
      append(std::uint16_t{3}, head);  // ASCII
      append(static_cast<std::uint32_t>(value.size()), head);
      texts += key + value;
    }
    append(static_cast<std::uint16_t>(kExtendedSize), body);
    append(static_cast<std::uint16_t>(head.size()), body);
    append(static_cast<std::uint32_t>(texts.size()), body);
    append(std::uint32_t{0}, body);  // the message's number, which only questions have
    body += content;
    body += head + texts;
  } else {
    body = content;
  }
  std::string message;
  message.reserve(kHeaderSize + body.size());
  append(static_cast<std::uint16_t>(header_version), message);
  append_field(type, IGTL_HEADER_TYPE_SIZE, message);
  append_field(device, IGTL_HEADER_NAME_SIZE, message);
  append(time_stamp, message);
  append(static_cast<std::uint64_t>(body.size()), message);
  append(checksum_of(body), message);
  return message += body;
}

std::uint64_t link_time_stamp() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto ns = static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
  constexpr std::uint64_t kSecond = 1'000'000'000;
  return ((ns / kSecond) << 32U) | (((ns % kSecond) << 32U) / kSecond);
}

std::string transform_content(const LinkTransform& transform) {
  std::array<float, 12> numbers{};  // the columns: three axes, then the place
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    numbers[n] =
        static_cast<float>(transform.matrix()(static_cast<Eigen::Index>(n % 3), static_cast<Eigen::Index>(n / 3)));
  }
  igtl_transform_convert_byte_order(numbers.data());
  std::string content(sizeof numbers, '\0');
  std::memcpy(content.data(), numbers.data(), sizeof numbers);
  return content;
}

std::optional<LinkTransform> transform_of(std::string_view content) {
  std::array<float, 12> numbers{};
  if (content.size() != sizeof numbers) return std::nullopt;
  std::memcpy(numbers.data(), content.data(), sizeof numbers);
  igtl_transform_convert_byte_order(numbers.data());
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    matrix(static_cast<Eigen::Index>(n % 3), static_cast<Eigen::Index>(n / 3)) = static_cast<double>(numbers[n]);
  }
  constexpr double kRotationTolerance = 1e-3;  // floats and trackers round; a scale or a mirror is no slip
  constexpr double kFarthestMm = 1e4;
  if (!matrix.allFinite() || !(matrix.topRightCorner<3, 1>().norm() < kFarthestMm)) return std::nullopt;
  const Mat3 rotation = matrix.topLeftCorner<3, 3>();
  const double off = (rotation.transpose() * rotation - Mat3::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kRotationTolerance) || !(rotation.determinant() > 0.0)) return std::nullopt;
  // What rounding left of a rotation is put right: an inverse is a transpose from here on.
  LinkTransform transform = LinkTransform::Identity();
  transform.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  transform.translation() = matrix.topRightCorner<3, 1>();
  return transform;
}

bool is_said_valid(const LinkMessage& message) {
  for (const auto& [key, value] : message.metadata) {
    const std::string said = lower_case(value);
    if (key.ends_with("Status") && said != "ok") return false;
    if (key.ends_with("Valid") && said != "true" && said != "1") return false;
  }
  return true;
}

std::string string_content(std::string_view text) {
  if (text.size() > 0xFFFFU) fail("link: expected a STRING of at most 65,535 letters, found ", text.size());
  std::string content;
  append(std::uint16_t{3}, content);  // ASCII
  append(static_cast<std::uint16_t>(text.size()), content);
  return content += text;
}

std::optional<std::string> string_of(std::string_view content) {
  if (content.size() < IGTL_STRING_HEADER_SIZE) return std::nullopt;
  const std::size_t length = number_at<std::uint16_t>(content, 2);
  if (length > content.size() - IGTL_STRING_HEADER_SIZE) return std::nullopt;
  return std::string(content.substr(IGTL_STRING_HEADER_SIZE, length));
}

std::string status_content(LinkStatusCode code, std::string_view name, std::string_view text) {
  std::string content;
  append(static_cast<std::uint16_t>(code), content);
  append(std::int64_t{0}, content);
  append_field(name, 20, content);
  content += text;
  content.push_back('\0');
  return content;
}

std::optional<int> status_of(std::string_view content) {
  if (content.size() < kStatusHeadSize) return std::nullopt;
  return number_at<std::uint16_t>(content, 0);
}

std::string point_content(std::span<const LinkPoint> points) {
  std::vector<igtl_point_element> elements(points.size());
  for (std::size_t n = 0; n < points.size(); ++n) {
    igtl_point_element& element = elements[n];
    std::memset(&element, 0, sizeof element);
    points[n].name.copy(element.name, IGTL_POINT_LEN_NAME - 1);
    points[n].group.copy(element.group_name, IGTL_POINT_LEN_GROUP_NAME - 1);
    constexpr std::array<igtl_uint8, 4> kColour{255, 200, 0, 255};
    std::copy(kColour.begin(), kColour.end(), element.rgba);
    for (int axis = 0; axis < 3; ++axis) element.position[axis] = static_cast<float>(points[n].place_mm[axis]);
    element.radius = static_cast<float>(points[n].radius_mm);
  }
  igtl_point_convert_byte_order(elements.data(), static_cast<int>(elements.size()));
  std::string content(elements.size() * sizeof(igtl_point_element), '\0');
  if (!elements.empty()) std::memcpy(content.data(), elements.data(), content.size());
  return content;
}

std::string polydata_content(std::span<const Eigen::Vector3f> vertices_mm,
                             std::span<const std::array<std::uint32_t, 3>> triangles) {
  std::vector<igtl_float32> points;
  points.reserve(3 * vertices_mm.size());
  for (const Eigen::Vector3f& vertex : vertices_mm) points.insert(points.end(), {vertex.x(), vertex.y(), vertex.z()});
  std::vector<igtl_uint32> polygons;
  polygons.reserve(4 * triangles.size());
  for (const auto& [a, b, c] : triangles) polygons.insert(polygons.end(), {3U, a, b, c});
  igtl_polydata_info info;
  igtl_polydata_init_info(&info);
  info.header.npoints = static_cast<igtl_uint32>(vertices_mm.size());
  info.header.npolygons = static_cast<igtl_uint32>(triangles.size());
  info.header.size_polygons = static_cast<igtl_uint32>(polygons.size() * sizeof(igtl_uint32));
  info.points = points.data();
  info.polygons = polygons.data();
  std::string content(igtl_polydata_get_size(&info, IGTL_TYPE_PREFIX_NONE), '\0');
  igtl_polydata_pack(&info, content.data(), IGTL_TYPE_PREFIX_NONE);
  return content;
}

std::string capability_content(std::span<const std::string_view> types) {
  std::string content;
  append(static_cast<std::uint32_t>(types.size()), content);
  for (const std::string_view type : types) append_field(type, IGTL_HEADER_TYPE_SIZE, content);
  return content;
}

}  // namespace spinaltap
