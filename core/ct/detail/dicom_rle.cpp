#include "core/ct/detail/dicom_rle.h"

#include <algorithm>
#include <cstdint>

namespace spinaltap {
namespace {

constexpr std::size_t kHeaderBytes = 64;

std::uint32_t u32_at(std::span<const char> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t n = 4; n-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + n]);
  return value;
}

/// Writes every `stride`-th byte of `values`. What follows the last value may be padding.
bool unpack(std::span<const char> segment, std::span<char> values, std::size_t stride) {
  std::size_t in = 0;
  for (std::size_t out = 0; out < values.size();) {
    if (in + 1 >= segment.size()) return false;
    const int byte = static_cast<unsigned char>(segment[in++]);
    const int code = byte < 128 ? byte : byte - 256;
    if (code == -128) continue;
    const auto count = static_cast<std::size_t>(code >= 0 ? code + 1 : 1 - code);
    const bool is_run = code < 0;
    if ((is_run ? 1 : count) > segment.size() - in) return false;
    for (std::size_t n = 0; n < count && out < values.size(); ++n, out += stride) {
      values[out] = segment[in + (is_run ? 0 : n)];
    }
    in += is_run ? 1 : count;
  }
  return true;
}

}  // namespace

bool decode_dicom_rle(std::span<const char> stream, int bytes_per_value, std::span<char> values) {
  const auto segments = static_cast<std::size_t>(bytes_per_value);
  if (stream.size() < kHeaderBytes || u32_at(stream, 0) != segments) return false;
  for (std::size_t n = 0; n < segments; ++n) {
    const std::size_t begin = u32_at(stream, 4 + 4 * n);
    const std::size_t end = n + 1 < segments ? u32_at(stream, 8 + 4 * n) : stream.size();
    if (begin < kHeaderBytes || begin > end || end > stream.size()) return false;
    // Most significant byte first in the file, last in memory.
    if (!unpack(stream.subspan(begin, end - begin), values.subspan(segments - 1 - n), segments)) return false;
  }
  return true;
}

}  // namespace spinaltap
