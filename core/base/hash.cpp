#include "core/base/hash.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>

namespace spinaltap {
namespace {

std::uint64_t state_after(std::uint64_t state, std::uint64_t word) {
  constexpr std::uint64_t kPrime = 0x100000001b3ULL;
  state = (state ^ word) * kPrime;
  return state ^ state >> 32;  // words, not bytes: fold the high half back so that it reaches every bit
}

/// Calls `take` with each 8 bytes, of the last as many as there are.
template <class Take>
void for_each_word(const void* data, std::size_t bytes, const Take& take) {
  const auto* next = static_cast<const unsigned char*>(data);
  while (bytes > 0) {
    std::uint64_t word = 0;
    const std::size_t taken = std::min<std::size_t>(bytes, sizeof word);
    std::memcpy(&word, next, taken);
    take(word);
    next += taken;
    bytes -= taken;
  }
}

}  // namespace

void WordHash64::add(const void* data, std::size_t bytes) {
  for_each_word(data, bytes, [this](std::uint64_t word) { state_ = state_after(state_, word); });
}

void WordHash64::add_to_both(WordHash64& first, WordHash64& second, const void* data, std::size_t bytes) {
  std::uint64_t a = first.state_, b = second.state_;
  for_each_word(data, bytes, [&](std::uint64_t word) {
    a = state_after(a, word);
    b = state_after(b, word);
  });
  first.state_ = a;
  second.state_ = b;
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
