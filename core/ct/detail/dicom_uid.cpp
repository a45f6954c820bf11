#include "core/ct/detail/dicom_uid.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/base/hash.h"
#include "core/base/random.h"

namespace spinaltap {

std::string dicom_uid_of(std::string_view content) {
  WordHash64 hash;
  hash.add(content.data(), content.size());
  const std::uint64_t high = (mix_bits(hash.value()) & ~(0xfULL << 12)) | 8ULL << 12;  // version
  WordHash64 salted;
  salted.add("second half", 11);
  salted.add(content.data(), content.size());
  const std::uint64_t low = (mix_bits(salted.value()) & ~(3ULL << 62)) | 2ULL << 62;  // variant

  // Decimal digits of a 128-bit number, by long division of its four 32-bit limbs.
  std::array<std::uint32_t, 4> limbs{static_cast<std::uint32_t>(high >> 32), static_cast<std::uint32_t>(high),
                                     static_cast<std::uint32_t>(low >> 32), static_cast<std::uint32_t>(low)};
  std::string digits;
  while (std::any_of(limbs.begin(), limbs.end(), [](std::uint32_t limb) { return limb != 0; })) {
    std::uint64_t remainder = 0;
    for (std::uint32_t& limb : limbs) {
      const std::uint64_t value = remainder << 32 | limb;
      limb = static_cast<std::uint32_t>(value / 10);
      remainder = value % 10;
    }
    digits.push_back(static_cast<char>('0' + remainder));
  }
  std::reverse(digits.begin(), digits.end());
  return "2.25." + digits;
}

}  // namespace spinaltap
