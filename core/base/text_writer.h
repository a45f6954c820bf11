#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <locale>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>

namespace spinaltap {

/// "%.*f": `decimals` digits after the point.
std::string fixed_text(double value, int decimals);

/// A share as a whole percentage: "42 %".
std::string percent_text(double share);

/// "%.*g": at most `digits` significant digits, without zeros at the end.
std::string short_text(double value, int digits = 6);

/// A whole number of at least `digits` digits, with zeros in front.
std::string padded_number(std::uint64_t number, std::size_t digits);

/// A stream in memory for what writes into streams. A plain one takes the host's locale, and turns bad without a word
/// where memory runs out; this one throws std::bad_alloc.
class TextStream : public std::ostringstream {
 public:
  TextStream() {
    imbue(std::locale::classic());
    exceptions(std::ios::badbit);
  }
};

/// Text put together from parts. Here, and in the functions above, numbers become text the same way under any locale
/// and in any host: a point before the decimals, nothing between thousands.
class TextWriter {
 public:
  /// Numbers with a fraction are written as short_text() has them.
  explicit TextWriter(int digits = 6) : digits_(digits) {}

  TextWriter& operator<<(std::string_view part) {
    text_ += part;
    return *this;
  }
  TextWriter& operator<<(char part) {
    text_ += part;
    return *this;
  }
  template <std::integral Number>
  TextWriter& operator<<(Number number) {
    text_ += std::to_string(number);
    return *this;
  }
  TextWriter& operator<<(double number) {
    text_ += short_text(number, digits_);
    return *this;
  }
  /// What else a stream takes: vectors, paths (in quotes).
  template <class Part>
  requires(!std::is_arithmetic_v<Part> && !std::convertible_to<const Part&, std::string_view>) TextWriter& operator<<(
      const Part& part) {
    TextStream text;
    text.precision(digits_);
    text << part;
    return *this << text.view();
  }

  const std::string& str() const { return text_; }

 private:
  int digits_;
  std::string text_;
};

/// The parts one after the other.
template <class... Parts>
std::string joined(const Parts&... parts) {
  TextWriter text;
  (text << ... << parts);
  return text.str();
}

}  // namespace spinaltap
