#include <algorithm>

#include "core/base/text_fields.h"
#include "core/rbf/detail/value_rows.h"

namespace spinaltap::detail {
namespace {

/// Which of kValueColumns stands in each of a file's columns.
struct Columns {
  std::vector<std::size_t> role;
  bool has_error_bars = false;
};

class CsvReader {
 public:
  CsvReader(FileReader& file, ValueRows& rows) : lines_(file), rows_(rows) {}

  void read() {
    std::string_view line;
    if (!lines_.next_filled(line)) return;
    line = without_byte_order_mark(line);
    std::string_view first;
    CsvFields(line).next(first);
    const bool has_header = !parse_number(first);
    const Columns columns = has_header ? named_columns(line) : ordered_columns(line);
    if (!has_header) add(line, columns);
    while (lines_.next_filled(line)) add(line, columns);
  }

 private:
  Columns named_columns(std::string_view header) const {
    Columns columns;
    std::array<bool, kValueColumns.size()> found{};
    CsvFields fields(header);
    for (std::string_view field; fields.next(field);) {
      const std::string name = csv_column_name(field);
      const auto* match = std::find(kValueColumns.begin(), kValueColumns.begin() + rows_.taken(), name);
      const auto role = static_cast<std::size_t>(match - kValueColumns.begin());
      columns.role.push_back(role < rows_.taken() ? role : kNoColumn);
      if (role >= rows_.taken()) continue;
      if (found[role]) fail("expected one column ", name, ", found two in ", lines_.place());
      found[role] = true;
    }
    for (std::size_t role = 0; role < rows_.needed(); ++role) {
      if (!found[role]) {
        fail("expected numbers or a header with the columns ", needed_columns(rows_), ", found ", in_quotes(header),
             " in ", lines_.place());
      }
    }
    columns.has_error_bars = found[kErrorBar];
    return columns;
  }

  Columns ordered_columns(std::string_view line) const {
    std::size_t count = 0;
    CsvFields fields(line);
    for (std::string_view field; fields.next(field);) ++count;
    const std::size_t max = rows_.needed() == 3 ? count : kValueColumns.size();
    if (count < rows_.needed() || count > max) {
      fail("expected ", rows_.needed() == 3 ? "at least 3" : "4 or 5", " numbers with commas between them (",
           needed_columns(rows_), "), or a header, found ", in_quotes(line), " in ", lines_.place());
    }
    Columns columns;
    for (std::size_t c = 0; c < count; ++c) columns.role.push_back(c < rows_.taken() ? c : kNoColumn);
    columns.has_error_bars = std::min(count, rows_.taken()) > kErrorBar;
    return columns;
  }

  void add(std::string_view line, const Columns& columns) {
    ValueRow row{};
    CsvFields fields(line);
    std::size_t count = 0;
    for (std::string_view field; fields.next(field); ++count) {
      const std::size_t role = count < columns.role.size() ? columns.role[count] : kNoColumn;
      if (role == kNoColumn) continue;
      const std::optional<double> number = parse_number(field);
      if (!number)
        fail("expected a number as ", kValueColumns[role], ", found ", in_quotes(field), " in ", lines_.place());
      row[role] = *number;
    }
    if (count != columns.role.size()) {
      fail("expected ", columns.role.size(), " columns, found ", count, " in ", lines_.place());
    }
    rows_.add(row, columns.has_error_bars, [this] { return lines_.place(); });
  }

  TextLines lines_;
  ValueRows& rows_;
};

}  // namespace

void read_csv_rows(FileReader& file, ValueRows& rows) { CsvReader(file, rows).read(); }

}  // namespace spinaltap::detail
