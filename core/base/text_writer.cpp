#include "core/base/text_writer.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace spinaltap {
namespace {

std::string written(double value, std::chars_format format, int digits) {
  std::array<char, 400> text{};  // the largest double has 309 digits before the point
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, format, digits);
  return {text.data(), end.ptr};
}

}  // namespace

std::string fixed_text(double value, int decimals) { return written(value, std::chars_format::fixed, decimals); }

std::string percent_text(double share) { return fixed_text(100.0 * share, 0) + " %"; }

std::string short_text(double value, int digits) { return written(value, std::chars_format::general, digits); }

std::string padded_number(std::uint64_t number, std::size_t digits) {
  const std::string text = std::to_string(number);
  return std::string(digits - std::min(digits, text.size()), '0') + text;
}

}  // namespace spinaltap
