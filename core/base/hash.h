#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace spinaltap {

/// 64-bit FNV-1a over 8-byte words: a quick fingerprint of data, the same on every machine of one byte order. Not a
/// defence against forgery.
class WordHash64 {
 public:
  void add(const void* data, std::size_t bytes);
  /// As add() of each, in the time of one: a state waits for its own multiplications.
  static void add_to_both(WordHash64& first, WordHash64& second, const void* data, std::size_t bytes);
  std::uint64_t value() const { return state_; }
  /// 16 hexadecimal digits.
  std::string hex() const;

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ULL;
};

/// CRC-32 as gzip and PNG have it: finds damage, though not malice. `before`: of the bytes before these.
std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before = 0);

}  // namespace spinaltap
