#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace spinaltap {

/// 64-bit FNV-1a over 8-byte words: a quick fingerprint of data, the same on every machine of one byte order. Not a
/// defence against forgery.
class WordHash64 {
 public:
  void add(const void* data, std::size_t bytes);
  std::uint64_t value() const { return state_; }
  /// 16 hexadecimal digits.
  std::string hex() const;

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ULL;
};

}  // namespace spinaltap
