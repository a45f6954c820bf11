#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace spinaltap {

/// Numbers of a DICOM decimal string such as "-30\135\-103.2"; NaN for a part that is not a number.
std::vector<double> parse_decimal_string(std::string_view text);

/// A number as a DICOM decimal string: the closest that fits into its 16 characters.
std::string to_decimal_string(double value);

/// The text of a DICOM value without its padding. Anything but printable ASCII becomes '?', so that it fits into a
/// message.
std::string dicom_text(std::string value);

/// The numbers of a decimal string value; NaN for a part that is not a number.
std::vector<double> dicom_decimals(std::string value);

/// An unsigned number of two or four bytes; 0 for a value of another length.
std::uint32_t dicom_unsigned(const std::string& value, bool big_endian);

}  // namespace spinaltap
