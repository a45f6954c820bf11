#include "tests/fuzz/mutate.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace spinaltap::test {
namespace {

constexpr std::array<std::uint32_t, 12> kOddNumbers{0,      1,      2,          0x7f,       0xff,       0x7fff,
                                                    0x8000, 0xffff, 0x7fffffff, 0x80000000, 0xfffffffe, 0xffffffff};
constexpr std::array<std::string_view, 10> kOddTexts{
    "nan", "inf", "-1", "0\\0", "1e308", "1e-300", "99999999999", "-0", "1\\0\\0\\1\\0\\0", ""};

struct Mutator {
  std::string& bytes;
  const std::string& other;
  std::mt19937_64& random;

  std::size_t below(std::size_t count) { return count > 0 ? random() % count : 0; }
  std::size_t somewhere() {
    if (below(3) == 0) return below(std::min<std::size_t>(bytes.size(), 400));  // heads matter most
    return below(bytes.size());
  }

  void flip_bit() { bytes[somewhere()] ^= static_cast<char>(1 << below(8)); }
  void set_byte() { bytes[somewhere()] = static_cast<char>(below(256)); }
  void set_number() {
    const std::uint32_t number = below(4) == 0 ? static_cast<std::uint32_t>(random()) : kOddNumbers[below(12)];
    const std::size_t size = below(2) == 0 ? 2 : 4;
    const bool big_endian = below(2) == 0;
    const std::size_t at = somewhere();
    for (std::size_t n = 0; n < size && at + n < bytes.size(); ++n) {
      bytes[at + n] = static_cast<char>(number >> (8 * (big_endian ? size - 1 - n : n)) & 0xff);
    }
  }
  /// Over digits, where a decimal string stands.
  void set_text() {
    const std::size_t digit = bytes.find_first_of("0123456789", somewhere());
    if (digit == std::string::npos) return;
    const std::string_view text = kOddTexts[below(kOddTexts.size())];
    for (std::size_t n = 0; n < text.size() && digit + n < bytes.size(); ++n) bytes[digit + n] = text[n];
  }
  void cut() { bytes.resize(somewhere()); }
  void remove() {
    const std::size_t at = somewhere();
    bytes.erase(at, 1 + below(16));
  }
  void repeat() {
    const std::size_t at = somewhere();
    const std::string piece = bytes.substr(at, 1 + below(64));
    bytes.insert(at, piece);
  }
  void splice() {
    if (other.empty()) return;
    const std::string piece = other.substr(below(other.size()), 1 + below(200));
    const std::size_t at = somewhere();
    bytes.replace(at, below(2) == 0 ? 0 : piece.size(), piece);
  }
};

}  // namespace

std::string mutated(std::string bytes, const std::string& other, std::mt19937_64& random) {
  Mutator mutator{bytes, other, random};
  for (std::size_t left = 1 + mutator.below(4); left > 0 && !bytes.empty(); --left) {
    switch (mutator.below(10)) {
      case 0:
      case 1:
        mutator.flip_bit();
        break;
      case 2:
        mutator.set_byte();
        break;
      case 3:
      case 4:
        mutator.set_number();
        break;
      case 5:
        mutator.set_text();
        break;
      case 6:
        mutator.cut();
        break;
      case 7:
        mutator.remove();
        break;
      case 8:
        mutator.repeat();
        break;
      default:
        mutator.splice();
    }
  }
  return bytes;
}

}  // namespace spinaltap::test
