#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace spinaltap {

/// The text of a DICOM value without its padding. Anything but printable ASCII becomes '?', so that it fits into a
/// message.
std::string dicom_text(std::string value);

/// The numbers of a decimal string value; NaN for a part that is not a number.
std::vector<double> dicom_decimals(std::string value);

/// An unsigned number of two or four bytes; 0 for a value of another length.
std::uint32_t dicom_unsigned(const std::string& value, bool big_endian);

}  // namespace spinaltap
