#include "core/ct/detail/dicom_values.h"

#include "core/ct/detail/dicom_decimal.h"

namespace spinaltap {

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
