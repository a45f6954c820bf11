#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/geometry.h"

// Messages of OpenIGTLink: what goes over the wire and what of it makes sense. Versions 1 and 2 of the protocol have
// the plain header, version 3 has an extended one and metadata. Nothing here knows a socket or a session.
namespace spinaltap {

/// Where something is of a frame: rotation and translation, mm.
using LinkTransform = Eigen::Isometry3d;

/// One message as it came, its checksum right and its parts within its size.
struct LinkMessage {
  int header_version = 1;        ///< 2: of protocol version 3
  std::string type;              ///< "TRANSFORM"
  std::string device;            ///< "Tool"
  std::uint64_t time_stamp = 0;  ///< as sent: seconds since 1970 in 32.32 bits; 0: none
  std::string content;           ///< the body without extended header and metadata
  std::map<std::string, std::string> metadata;
};

/// Why something that came was not taken. Each is counted.
enum class LinkRejection : std::uint8_t {
  header,         ///< no header of OpenIGTLink: nothing that follows can be found, the connection ends
  size,           ///< a body larger than its type has
  checksum,       ///< CRC-64 of the body
  content,        ///< a body that is not what its type says: numbers that are none, no rotation, lengths beyond it
  type,           ///< a type that nothing is done with; passed over
  device,         ///< a transform of a device that nobody asked for; passed over
  not_in_charge,  ///< a tool, reference or patient from a second sender while the first one still sends
  command,        ///< a STRING that is no command
  half,           ///< a message that began and did not end in time; the connection ends
  hanging,        ///< a peer that does not read what it is sent; the connection ends
  too_many        ///< a peer more than there may be
};
inline constexpr std::size_t kLinkRejections = 11;
/// "header", "size", "checksum", ...
std::string_view name_of(LinkRejection refusal);
using LinkRejections = std::array<std::uint64_t, kLinkRejections>;

/// Takes a stream of bytes apart into messages, whatever pieces it comes in. No size that a header claims is believed
/// before it is checked: bodies of types that are known are at most 128 kB, all others are passed over uncopied.
class LinkReader {
 public:
  using Sink = std::function<void(LinkMessage&&)>;
  using RejectionSink = std::function<void(LinkRejection)>;

  /// False: the stream is lost, and so is all that follows.
  bool take(std::string_view bytes, const Sink& sink, const RejectionSink& refused);
  /// In the middle of a message.
  bool is_within() const { return !buffer_.empty() || skip_ > 0; }

  static constexpr std::size_t kMaxBody = std::size_t{128} << 10U;
  static constexpr std::uint64_t kMaxPassedOver = std::uint64_t{256} << 20U;  ///< of an image, say

 private:
  bool begin(const RejectionSink& refused);
  void end(const Sink& sink, const RejectionSink& refused);

  std::string buffer_;    ///< of the present message
  std::size_t body_ = 0;  ///< its size; known once there is a header
  bool has_header_ = false;
  std::uint64_t skip_ = 0;  ///< of a body that nobody wants
};

/// A whole message. `content` is a body as those below make it; `device` is cut at 19 letters. With header version 2 it
/// has an extended header and the metadata, which version 1 leaves out.
std::string pack_message(std::string_view type, std::string_view device, std::string_view content,
                         int header_version = 1, std::uint64_t time_stamp = 0,
                         const std::map<std::string, std::string>& metadata = {});
/// Of the host's clock, as messages have it.
std::uint64_t link_time_stamp();

/// TRANSFORM
std::string transform_content(const LinkTransform& transform);
/// Nothing where it is none: another size, numbers that are not finite, no rotation within 0.001, 10 m away.
std::optional<LinkTransform> transform_of(std::string_view content);
/// What metadata say of a transform: false where a key that ends in "Status" is not "OK", or one in "Valid" not true.
bool is_said_valid(const LinkMessage& message);

/// STRING, ASCII. Throws Error on more than 65,535 letters.
std::string string_content(std::string_view text);
std::optional<std::string> string_of(std::string_view content);

/// STATUS, as OpenIGTLink numbers it.
enum class LinkStatusCode : std::uint16_t { ok = 1, time_out = 7, not_ready = 13, shut_down = 19 };
std::string status_content(LinkStatusCode code, std::string_view name, std::string_view text);
/// The code.
std::optional<int> status_of(std::string_view content);

/// POINT: `place` in the frame outside (RAS), mm.
struct LinkPoint {
  std::string name;
  std::string group;
  Vec3 place_mm = Vec3::Zero();
  double radius_mm = 0.0;
};
std::string point_content(std::span<const LinkPoint> points);

/// POLYDATA of triangles; vertices in the frame outside (RAS), mm. Without any it is what is no longer there.
std::string polydata_content(std::span<const Eigen::Vector3f> vertices_mm,
                             std::span<const std::array<std::uint32_t, 3>> triangles);

/// CAPABILITY
std::string capability_content(std::span<const std::string_view> types);

}  // namespace spinaltap
