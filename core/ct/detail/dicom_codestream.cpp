#include "core/ct/detail/dicom_codestream.h"

#include <cstddef>

namespace spinaltap {
namespace {

/// Big endian numbers; beyond the end they read as 0.
class BigEndian {
 public:
  explicit BigEndian(std::span<const char> bytes) : bytes_(bytes) {}
  std::size_t size() const { return bytes_.size(); }
  int u8(std::size_t at) const { return at < bytes_.size() ? static_cast<unsigned char>(bytes_[at]) : 0; }
  int u16(std::size_t at) const { return u8(at) << 8 | u8(at + 1); }
  long long u32(std::size_t at) const { return static_cast<long long>(u16(at)) << 16 | u16(at + 2); }

 private:
  std::span<const char> bytes_;
};

/// `siz`: where the marker SIZ stands.
std::optional<CodestreamSize> jpeg2000_size(const BigEndian& bytes, std::size_t siz) {
  const auto number = [&](std::size_t at) { return bytes.u32(siz + at); };
  const bool is_subsampled = bytes.u8(siz + 41) != 1 || bytes.u8(siz + 42) != 1;
  if (is_subsampled) return std::nullopt;
  // Decoders take memory for each tile that a header claims, before they look for it.
  constexpr long long kMostTiles = 4096;
  const long long tile_columns = number(22);
  const long long tile_rows = number(26);
  if (tile_columns < 1 || tile_rows < 1) return std::nullopt;
  const long long tiles = (number(6) / tile_columns + 1) * (number(10) / tile_rows + 1);
  if (tiles > kMostTiles) return std::nullopt;
  return CodestreamSize{number(6) - number(14), number(10) - number(18), bytes.u16(siz + 38),
                        (bytes.u8(siz + 40) & 0x7f) + 1};
}

std::optional<CodestreamSize> jpeg_size(const BigEndian& bytes) {
  for (std::size_t at = 2; at + 10 <= bytes.size();) {
    const int marker = bytes.u16(at);
    if (marker == 0xffff) {  // fill byte
      ++at;
      continue;
    }
    const bool is_frame =
        (marker >= 0xffc0 && marker <= 0xffcf && marker != 0xffc4 && marker != 0xffc8 && marker != 0xffcc) ||
        marker == 0xfff7;  // JPEG-LS
    if (is_frame) {
      return CodestreamSize{bytes.u16(at + 7), bytes.u16(at + 5), bytes.u8(at + 9), bytes.u8(at + 4)};
    }
    const int length = bytes.u16(at + 2);
    if (marker < 0xffc0 || marker == 0xffda || length < 2) return std::nullopt;
    at += 2 + static_cast<std::size_t>(length);
  }
  return std::nullopt;
}

}  // namespace

std::optional<CodestreamSize> codestream_size(std::span<const char> span) {
  const BigEndian bytes(span);
  constexpr long long kStartAndSize = 0xff4fff51;
  if (bytes.u32(0) == kStartAndSize) return jpeg2000_size(bytes, 2);
  if (bytes.u16(0) == 0xffd8) return jpeg_size(bytes);
  return std::nullopt;
}

}  // namespace spinaltap
