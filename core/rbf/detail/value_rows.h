#pragma once

#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/base/file_stream.h"
#include "core/base/text_fields.h"
#include "core/rbf/fit_rbf.h"

namespace spinaltap::detail {

/// What a file with points has of each, in the order in which it stands without a header.
inline constexpr std::array<std::string_view, 5> kValueColumns{"x", "y", "z", "value", "error_bar"};
inline constexpr std::size_t kErrorBar = 4;
/// Of a file's column: none of these.
inline constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);

using ValueRow = std::array<double, kValueColumns.size()>;

/// Gathers the rows of a file.
class ValueRows {
 public:
  explicit ValueRows(bool wants_values) : wants_values_(wants_values) {}

  /// Columns that there must be: the first 3 or 4.
  std::size_t needed() const { return wants_values_ ? 4 : 3; }
  /// Columns that are taken where there are such.
  std::size_t taken() const { return wants_values_ ? kValueColumns.size() : 3; }

  void reserve(std::size_t rows, bool has_error_bars) {
    values_.points_mm.reserve(rows);
    if (wants_values_) values_.values_mm.reserve(rows);
    if (wants_values_ && has_error_bars) values_.error_bars_mm.reserve(rows);
  }

  /// Takes a row. Throws Error when a number of it will not do; `place()` says where it stands.
  template <class Place>
  void add(const ValueRow& row, bool has_error_bars, const Place& place) {
    const std::size_t columns = wants_values_ ? (has_error_bars ? 5 : 4) : 3;
    for (std::size_t c = 0; c < columns; ++c) {
      if (!std::isfinite(row[c])) {
        fail("expected a finite ", kValueColumns[c], ", found ", row[c], " in ", place());
      }
    }
    values_.points_mm.emplace_back(row[0], row[1], row[2]);
    if (wants_values_) values_.values_mm.push_back(row[3]);
    if (columns <= kErrorBar) return;
    if (!(row[kErrorBar] >= 0.0)) {
      fail("expected an error_bar of 0 mm or more, found ", row[kErrorBar], " in ", place());
    }
    values_.error_bars_mm.push_back(row[kErrorBar]);
  }

  RbfValues& values() { return values_; }

 private:
  bool wants_values_;
  RbfValues values_;
};

/// "x, y, z, value": the columns that there must be.
inline std::string needed_columns(const ValueRows& rows) { return rows.needed() == 3 ? "x, y, z" : "x, y, z, value"; }

// One file each; see read_values().
void read_csv_rows(FileReader& file, ValueRows& rows);
void read_ply_rows(FileReader& file, ValueRows& rows);

}  // namespace spinaltap::detail
