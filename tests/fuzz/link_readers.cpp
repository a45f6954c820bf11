// What comes over OpenIGTLink: streams of messages.

#include <cmath>
#include <stdexcept>

#include "apps/link/link_frames.h"
#include "apps/link/link_message.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "tests/fuzz/readers.h"

namespace spinaltap::test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHead = 58, kSizeAt = 42, kChecksumAt = 50;

/// Each message with the checksum of the body that it now has, as far as sizes lead from one to the next.
std::string with_checksums(const std::string& stream) {
  std::string bytes = stream;
  for (std::size_t at = 0; at + kHead <= bytes.size();) {
    std::uint64_t size = 0;
    for (std::size_t n = 0; n < 8; ++n) size = (size << 8U) | static_cast<unsigned char>(bytes[at + kSizeAt + n]);
    if (size > bytes.size() - at - kHead) break;
    const std::string body = bytes.substr(at + kHead, size);
    bytes.replace(at + kChecksumAt, 8, pack_message("STRING", "", body).substr(kChecksumAt, 8));
    at += kHead + size;
  }
  return bytes;
}

std::vector<Seed> stream_seeds() {
  LinkTransform transform = LinkTransform::Identity();
  transform.linear() = Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  transform.translation() = Vec3(12.0, -80.0, 431.0);
  const std::string place = transform_content(transform);
  std::string plain, extended;
  for (const char* device : {"Patient", "Reference", "Tool", "Tool"}) {
    plain += pack_message("TRANSFORM", device, place, 1, 77);
    extended += pack_message("TRANSFORM", device, place, 2, 77, {{"ToolToTrackerTransformStatus", "OK"}, {"x", "y"}});
  }
  plain += pack_message("STRING", "Command", string_content("SPINDLE ON"));
  plain += pack_message("STATUS", "Tool", status_content(LinkStatusCode::time_out, "gone", "out of sight"));
  plain += pack_message("IMAGE", "US", std::string(300, 'x')) + pack_message("GET_STATUS", "", "");
  extended += pack_message("STRING", "Command", string_content("END"), 2, 0, {{"key", "value"}});
  return {{"messages of version 1", {{"stream", plain, with_checksums}}},
          {"messages of version 3", {{"stream", extended, with_checksums}}}};
}

/// As a server does, in pieces of all sizes.
void read_stream(const fs::path& folder) {
  const std::string bytes = read_whole_file(only_file(folder));
  LinkReader reader;
  Tracking tracking({});
  std::int64_t now_ns = 0;
  std::size_t refused = 0;
  const auto take = [&](LinkMessage&& message) {
    if (message.content.size() > LinkReader::kMaxBody) throw std::length_error("a message larger than may be");
    static_cast<void>(is_said_valid(message));
    static_cast<void>(string_of(message.content));
    static_cast<void>(status_of(message.content));
    if (const std::optional<LinkTransform> transform = transform_of(message.content)) {
      tracking.update(LinkDevice::tool, *transform, true, ++now_ns);
      const std::optional<Pose> pose = tracking.pose(now_ns);
      if (!pose || !pose->tip_mm.allFinite() || !(std::abs(pose->axis.norm() - 1.0) < 1e-9)) {
        throw std::logic_error("a transform that is no pose");
      }
    }
  };
  std::size_t piece = 1;
  for (std::size_t at = 0; at < bytes.size(); at += piece, piece = piece * 7 % 251) {
    if (!reader.take(std::string_view(bytes).substr(at, piece), take, [&](LinkRejection) { ++refused; })) {
      fail("link: expected a header of OpenIGTLink, found none");
    }
  }
}

}  // namespace

void add_link_readers(std::vector<Reader>& readers) { readers.push_back({"link", stream_seeds, read_stream}); }

}  // namespace spinaltap::test
