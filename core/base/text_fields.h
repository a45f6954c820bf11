#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace spinaltap {

/// The number that the whole of `text` is, whatever the locale; nothing when it is none, or beyond a double's range.
/// Blanks around it and a plus sign are let pass. "nan" and "inf" are numbers here.
std::optional<double> parse_number(std::string_view text);

/// Those of a text that is numbers with blanks between, no more; nothing where one is none.
std::optional<std::vector<double>> parse_numbers(std::string_view text);

/// The shortest text that gives `number` back exactly, appended to `text`.
void append_number(double number, std::string& text);

/// The same in a field of a CSV, which stays empty where the number is infinite or none: gawk takes "inf" for 0,
/// SQLite for text, and an empty field is a missing value to most readers.
void append_csv_number(double number, std::string& text);

/// Without blanks and tabs at both ends.
std::string_view trimmed(std::string_view text);

/// With the letters A to Z (a to z) made small (capital), whatever the locale; other bytes as they are.
std::string lower_case(std::string_view text);
std::string upper_case(std::string_view text);

/// Length of the valid UTF-8 sequence at `i` (Unicode 15, table 3-7), 0 where there is none.
std::size_t utf8_length(std::string_view text, std::size_t i);
/// Whether a UTF-8 character is one of ASCII's or Latin-1's that steer a terminal; newline and tab are.
bool is_control(std::string_view character);

/// Text out of a file for a message: 40 characters at most, "?" for what is none of UTF-8 or steers a terminal.
std::string shown(std::string_view text);
/// As shown(), in quotes.
std::string in_quotes(std::string_view text);

/// A line of a CSV file, field by field.
class CsvFields {
 public:
  explicit CsvFields(std::string_view line) : rest_(line) {}

  /// The next field as it stands; false when there is none. One in quotes may hold commas.
  bool next(std::string_view& field);

 private:
  std::string_view rest_;
  bool has_more_ = true;
};

/// A header's field as a column's name: lower case, without quotes.
std::string csv_column_name(std::string_view field);

/// A file's first line without the byte order mark that Excel writes.
std::string_view without_byte_order_mark(std::string_view line);

}  // namespace spinaltap
