#include "apps/report/text.h"

#include <cmath>
#include <cstddef>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

std::string fixed(double value, int decimals) {
  std::string text = fixed_text(value, decimals);
  const bool is_zero = text.find_first_of("123456789") == std::string::npos;
  if (is_zero && text.front() == '-') text.erase(0, 1);
  return text;
}

}  // namespace

std::string escape_html(std::string_view text) {
  constexpr std::string_view kReplacement = "\xEF\xBF\xBD";
  std::string safe;
  safe.reserve(text.size() + text.size() / 8);
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(text, i);
    const std::string_view character = text.substr(i, length == 0 ? 1 : length);
    i += character.size();
    if (length == 0 || (is_control(character) && character != "\n" && character != "\t")) {
      safe += kReplacement;
    } else if (character == "&") {
      safe += "&amp;";
    } else if (character == "<") {
      safe += "&lt;";
    } else if (character == ">") {
      safe += "&gt;";
    } else if (character == "\"") {
      safe += "&quot;";
    } else if (character == "'") {
      safe += "&#39;";
    } else {
      safe += character;
    }
  }
  return safe;
}

std::string svg_number(double value, int decimals) {
  if (!std::isfinite(value)) fail("figure: expected a finite coordinate, found ", value);
  std::string text = fixed(value, decimals);
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string readable_number(double value, int decimals) {
  if (!std::isfinite(value)) return "n/a";
  std::string text = fixed(value, decimals);
  const std::size_t first_digit = text.front() == '-' ? 1 : 0;
  const std::size_t point = text.find('.');
  for (std::size_t i = point == std::string::npos ? text.size() : point; i > first_digit + 3;) {
    i -= 3;
    text.insert(i, 1, ',');
  }
  return text;
}

std::string interval_text(const Interval& range, int decimals) {
  return readable_number(range.low, decimals) + " to " + readable_number(range.high, decimals);
}

}  // namespace spinaltap
