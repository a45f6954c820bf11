#include "core/ct/detail/dicom_values.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/base/error.h"

namespace spinaltap {

std::vector<double> parse_decimal_string(std::string_view text) {
  std::vector<double> values;
  if (text.empty()) return values;
  while (true) {
    const std::size_t end = text.find('\\');
    std::string_view part = text.substr(0, end);
    while (!part.empty() && part.front() == ' ') part.remove_prefix(1);
    while (!part.empty() && part.back() == ' ') part.remove_suffix(1);
    if (!part.empty() && part.front() == '+') part.remove_prefix(1);
    double value = 0.0;
    const auto [stop, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    const bool is_number = error == std::errc{} && stop == part.data() + part.size() && !part.empty();
    values.push_back(is_number ? value : std::numeric_limits<double>::quiet_NaN());
    if (end == std::string_view::npos) return values;
    text.remove_prefix(end + 1);
  }
}

std::string to_decimal_string(double value) {
  constexpr std::size_t kMaxCharacters = 16;  // PS3.5, table 6.2-1
  if (!std::isfinite(value)) fail("expected a number to write into a DICOM file, found ", value);
  if (value == 0.0) return "0";  // not "-0"
  std::array<char, 40> text{};
  char* const first = text.data();
  char* const last = first + text.size();
  std::to_chars_result result = std::to_chars(first, last, value);
  for (int digits = 15; result.ptr - first > static_cast<std::ptrdiff_t>(kMaxCharacters); --digits) {
    result = std::to_chars(first, last, value, std::chars_format::general, digits);
  }
  return {first, result.ptr};
}

std::string dicom_text(std::string value) {
  const std::string padding(" \0", 2);
  const std::size_t first = value.find_first_not_of(padding);
  if (first == std::string::npos) return {};
  value = value.substr(first, value.find_last_not_of(padding) - first + 1);
  for (char& c : value) {
    if (c < ' ' || c > '~') c = '?';
  }
  return value;
}

std::vector<double> dicom_decimals(std::string value) { return parse_decimal_string(dicom_text(std::move(value))); }

std::uint32_t dicom_unsigned(const std::string& value, bool big_endian) {
  if (value.size() != 2 && value.size() != 4) return 0;
  std::uint32_t number = 0;
  for (std::size_t n = 0; n < value.size(); ++n) {
    const char byte = value[big_endian ? n : value.size() - 1 - n];
    number = number << 8 | static_cast<unsigned char>(byte);
  }
  return number;
}

}  // namespace spinaltap
