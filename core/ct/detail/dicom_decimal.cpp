#include "core/ct/detail/dicom_decimal.h"

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

}  // namespace spinaltap
