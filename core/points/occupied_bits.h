#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace spinaltap {

/// Calls visit(index) for every set bit of [begin, end), upwards, until it returns false. Whether it never did.
/// `visit` may clear the bit that it is called for.
template <class Visit>
bool visit_up(const std::uint64_t* words, std::size_t begin, std::size_t end, const Visit& visit) {
  if (begin >= end) return true;
  const std::size_t last = (end - 1) / 64;
  for (std::size_t n = begin / 64; n <= last; ++n) {
    std::uint64_t word = words[n];
    if (n == begin / 64) word &= ~std::uint64_t{0} << (begin % 64);
    if (n == last) word &= ~std::uint64_t{0} >> (63 - (end - 1) % 64);
    while (word != 0) {
      if (!visit(64 * n + static_cast<std::size_t>(std::countr_zero(word)))) return false;
      word &= word - 1;
    }
  }
  return true;
}

/// The same, downwards.
template <class Visit>
bool visit_down(const std::uint64_t* words, std::size_t begin, std::size_t end, const Visit& visit) {
  if (begin >= end) return true;
  const std::size_t first = begin / 64;
  for (std::size_t n = (end - 1) / 64 + 1; n-- > first;) {
    std::uint64_t word = words[n];
    if (n == first) word &= ~std::uint64_t{0} << (begin % 64);
    if (n == (end - 1) / 64) word &= ~std::uint64_t{0} >> (63 - (end - 1) % 64);
    while (word != 0) {
      const int bit = 63 - std::countl_zero(word);
      if (!visit(64 * n + static_cast<std::size_t>(bit))) return false;
      word &= ~(std::uint64_t{1} << bit);
    }
  }
  return true;
}

}  // namespace spinaltap
