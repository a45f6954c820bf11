#pragma once

#include <string>
#include <string_view>

#include "core/base/statistics.h"

namespace spinaltap {

/// Text made safe for HTML and SVG, in elements and in quoted attributes: & < > " ' become entities; control characters
/// and bytes that are not UTF-8 become U+FFFD.
std::string escape_html(std::string_view text);

/// A number for SVG geometry: at most `decimals` digits after the point, trailing zeros dropped, never "-0". The point
/// is a point in every locale. Throws Error when the value is not finite.
std::string svg_number(double value, int decimals = 2);

/// A number for people: exactly `decimals` digits after the point, thousands set apart by commas ("12,345.6");
/// "n/a" when the value is not finite.
std::string readable_number(double value, int decimals);

/// A range for people, "1.2 to 53.0", both ends as readable_number() has them.
std::string interval_text(const Interval& range, int decimals);

}  // namespace spinaltap
