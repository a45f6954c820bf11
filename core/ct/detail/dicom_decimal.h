#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace spinaltap {

/// Numbers of a DICOM decimal string such as "-30\135\-103.2"; NaN for a part that is not a number.
std::vector<double> parse_decimal_string(std::string_view text);

/// A number as a DICOM decimal string: the closest that fits into its 16 characters.
std::string to_decimal_string(double value);

}  // namespace spinaltap
