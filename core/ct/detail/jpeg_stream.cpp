#include "core/ct/detail/jpeg_stream.h"

#include <algorithm>
#include <array>
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
  constexpr long long kMaxTiles = 4096;
  const long long tile_columns = number(22);
  const long long tile_rows = number(26);
  if (tile_columns < 1 || tile_rows < 1) return std::nullopt;
  const long long tiles = (number(6) / tile_columns + 1) * (number(10) / tile_rows + 1);
  if (tiles > kMaxTiles) return std::nullopt;
  return CodestreamSize{number(6) - number(14), number(10) - number(18), bytes.u16(siz + 38),
                        (bytes.u8(siz + 40) & 0x7f) + 1, (bytes.u8(siz + 40) & 0x80) != 0};
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
      return CodestreamSize{bytes.u16(at + 7), bytes.u16(at + 5), bytes.u8(at + 9), bytes.u8(at + 4), std::nullopt};
    }
    const int length = bytes.u16(at + 2);
    if (marker < 0xffc0 || marker == 0xffda || length < 2) return std::nullopt;
    at += 2 + static_cast<std::size_t>(length);
  }
  return std::nullopt;
}

constexpr int kStart = 0xd8;
constexpr int kEnd = 0xd9;
constexpr int kHuffmanTables = 0xc4;
constexpr int kScan = 0xda;
constexpr int kQuantization = 0xdb;
constexpr int kRestartInterval = 0xdd;

bool is_frame(int marker) { return marker == 0xc0 || marker == 0xc1 || marker == 0xc3; }
bool is_ignored(int marker) { return (marker >= 0xe0 && marker <= 0xef) || marker == 0xfe; }  // application, comment
bool is_restart(int marker) { return marker >= 0xd0 && marker <= 0xd7; }

class Stream {
 public:
  explicit Stream(std::span<const char> bytes) : bytes_(bytes) {}

  std::optional<std::vector<char>> plain() {
    if (u8(0) != 0xff || u8(1) != kStart) return std::nullopt;
    keep(0, 2);
    at_ = 2;
    while (true) {
      while (u8(at_) == 0xff && u8(at_ + 1) == 0xff) ++at_;  // fill bytes
      if (u8(at_) != 0xff || at_ + 4 > bytes_.size()) return std::nullopt;
      const int marker = u8(at_ + 1);
      const auto length = static_cast<std::size_t>(u8(at_ + 2) << 8 | u8(at_ + 3));
      if (length < 2 || length > bytes_.size() - at_ - 2 || !take(marker, length)) return std::nullopt;
      at_ += 2 + length;
      if (marker == kScan) break;
    }
    if (frames_ != 1) return std::nullopt;
    keep_scan();
    return std::move(plain_);
  }

 private:
  int u8(std::size_t at) const { return at < bytes_.size() ? static_cast<unsigned char>(bytes_[at]) : -1; }
  void keep(std::size_t at, std::size_t count) {
    const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(at);
    plain_.insert(plain_.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
  }

  /// Checks a segment and keeps it where it is needed. `length`: as the segment states it.
  bool take(int marker, std::size_t length) {
    if (is_ignored(marker)) return true;
    if (is_frame(marker)) {
      constexpr std::size_t kOneComponent = 11;
      ++frames_;
      is_lossless_ = marker == 0xc3;
      component_ = u8(at_ + 10);
      if (length != kOneComponent || u8(at_ + 9) != 1 || frames_ > 1) return false;
      if (u8(at_ + 11) != 0x11) return false;  // not subsampled
    } else if (marker == kScan) {
      constexpr std::size_t kOneComponentScan = 8;
      if (length != kOneComponentScan || u8(at_ + 4) != 1 || u8(at_ + 5) != component_ || !good_scan()) return false;
    } else if (marker == kRestartInterval) {
      if (length != 4) return false;
    } else if (marker == kHuffmanTables) {
      if (!good_huffman_tables(length)) return false;
    } else if (marker != kQuantization) {
      return false;
    }
    keep(at_, 2 + length);
    return true;
  }

  /// Spectral selection, or the predictor; and the point transform.
  bool good_scan() const {
    const int first = u8(at_ + 7);
    const int last = u8(at_ + 8);
    if (is_lossless_) return first >= 1 && first <= 7 && last == 0 && (u8(at_ + 9) & 0xf0) == 0;
    return first == 0 && last == 63 && u8(at_ + 9) == 0;
  }

  bool good_huffman_tables(std::size_t length) const {
    constexpr int kMaxSymbols = 256;
    const std::size_t end = at_ + 2 + length;
    for (std::size_t at = at_ + 4; at < end;) {
      if (end - at < 17) return false;
      int symbols = 0;
      int codes_left = 1;  // codes of the present length that no shorter one begins
      for (std::size_t bits = 1; bits <= 16; ++bits) {
        const int count = u8(at + bits);
        symbols += count;
        codes_left = 2 * codes_left - count;
        if (codes_left < 0) return false;
      }
      at += 17;
      if (symbols > kMaxSymbols || static_cast<std::size_t>(symbols) > end - at) return false;
      at += static_cast<std::size_t>(symbols);
    }
    return true;
  }

  /// What follows the scan, such as another scan, is left away.
  void keep_scan() {
    std::size_t end = at_;
    while (end + 1 < bytes_.size() && !(u8(end) == 0xff && u8(end + 1) != 0 && !is_restart(u8(end + 1)))) ++end;
    if (end + 1 >= bytes_.size()) end = bytes_.size();
    keep(at_, end - at_);
    plain_.push_back(static_cast<char>(0xff));
    plain_.push_back(static_cast<char>(kEnd));
  }

  std::span<const char> bytes_;
  std::vector<char> plain_;
  std::size_t at_ = 0;
  int frames_ = 0;
  int component_ = -1;
  bool is_lossless_ = false;
};

}  // namespace

std::optional<CodestreamSize> codestream_size(std::span<const char> span) {
  const BigEndian bytes(span);
  constexpr long long kStartAndSize = 0xff4fff51;
  if (bytes.u32(0) == kStartAndSize) return jpeg2000_size(bytes, 2);
  if (bytes.u16(0) == 0xffd8) return jpeg_size(bytes);
  return std::nullopt;
}

std::optional<std::vector<char>> plain_jpeg_stream(std::span<const char> bytes) { return Stream(bytes).plain(); }

}  // namespace spinaltap
