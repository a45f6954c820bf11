#include "core/base/hash.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>

namespace spinaltap {

void WordHash64::add(const void* data, std::size_t bytes) {
  constexpr std::uint64_t kPrime = 0x100000001b3ULL;
  const auto* next = static_cast<const unsigned char*>(data);
  while (bytes > 0) {
    std::uint64_t word = 0;
    const std::size_t taken = std::min<std::size_t>(bytes, sizeof word);
    std::memcpy(&word, next, taken);
    state_ = (state_ ^ word) * kPrime;
    state_ ^= state_ >> 32;  // words, not bytes: fold the high half back so that it reaches every bit
    next += taken;
    bytes -= taken;
  }
}

std::string WordHash64::hex() const {
  std::string text(16, '0');
  for (int digit = 0; digit < 16; ++digit) {
    text[static_cast<std::size_t>(15 - digit)] = "0123456789abcdef"[(state_ >> (4 * digit)) & 15];
  }
  return text;
}

std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before) {
  if (bytes.empty()) return before;  // zlib would begin anew at a null pointer
  return static_cast<std::uint32_t>(crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace spinaltap
