#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>

#include "core/base/hdf5_file.h"
#include "core/session/record/session_record.h"

namespace spinaltap {

/// One quantity of a record's rows, each of which is a Row in memory: what it is called, and how it gets in and out.
template <class Row>
struct RecordColumn {
  const char* name = "";                      ///< of the table in the file, with the unit
  std::array<const char*, 3> csv_names = {};  ///< of its numbers; the first alone where it is one
  Hdf5Number number = Hdf5Number::f64;
  std::size_t width = 1;      ///< numbers in a row
  std::size_t row_bytes = 0;  ///< of them all
  void (*store)(const Row& row, void* to) = nullptr;
  void (*load)(Row& row, const void* from) = nullptr;
};

/// In the order of the file's documentation, docs/record-file.md.
std::span<const RecordColumn<RecordedCycle>> cycle_columns(RecordParts parts);
std::span<const RecordColumn<SessionEvent>> event_columns();

/// Every bit of every quantity is the same.
template <class Row>
bool same_bits(std::span<const RecordColumn<Row>> columns, const Row& a, const Row& b) {
  for (const RecordColumn<Row>& column : columns) {
    std::array<std::byte, 24> of_a{};
    std::array<std::byte, 24> of_b{};
    column.store(a, of_a.data());
    column.store(b, of_b.data());
    if (of_a != of_b) return false;
  }
  return true;
}

/// Appends a number of a column, as it stands in memory, to `text`: so that it comes back exactly.
void append_number(Hdf5Number number, const void* from, std::string& text);
/// Bytes that one takes.
std::size_t bytes_of(Hdf5Number number);

}  // namespace spinaltap
