#pragma once

#include <string>
#include <string_view>

namespace spinaltap {

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
