#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/hash.h"
#include "core/session/record/detail/record_columns.h"

namespace spinaltap {

// What writer and reader of records share; docs/record-file.md.

inline constexpr const char* kRecordFormat = "spinaltap-record";
inline constexpr const char* kRecordVersion = "3";
inline constexpr const char* kRecordVersionWithoutTools = "2";  ///< read as well

/// A chunk of rows is compressed and written at one go: 256 ms at 1 kHz.
inline constexpr std::uint64_t kCycleChunk = 256;
inline constexpr std::uint64_t kEventChunk = 64;

/// What the file holds for sure: written, in one piece, after all that it counts. A file that was cut short may hold
/// more rows than that, and not all of their numbers.
struct RecordProgress {
  static constexpr std::uint64_t kNumbers = 6;
  static constexpr std::uint64_t kNumbersWithoutTools = 5;

  std::uint64_t cycles = 0;  ///< rows
  std::uint64_t events = 0;  ///< rows
  std::uint64_t lost = 0;    ///< cycles that are not in the file
  std::uint64_t is_whole = 0;
  std::uint64_t tools = 0;  ///< rows

  std::array<std::uint64_t, kNumbers> numbers() const {
    std::array<std::uint64_t, kNumbers> all{cycles, events, lost, is_whole, tools, 0};
    all.back() = checksum(std::span(all).first(kNumbers - 1));
    return all;
  }
  /// Of the numbers before it.
  static std::uint64_t checksum(std::span<const std::uint64_t> numbers) {
    WordHash64 hash;
    hash.add(numbers.data(), numbers.size_bytes());
    return hash.value();
  }
};

/// The tables of the tools that a session changed to.
struct ToolTables {
  static constexpr std::uint64_t kToolChunk = 4;
  Hdf5Table cycle, tool;

  static ToolTables make(Hdf5File& file) {
    file.make_group("/tools");
    return {file.make_table("/tools/cycle", Hdf5Number::u64, 1, kToolChunk, false),
            file.make_table("/tools/tool", Hdf5Number::u8, RecordedTool::kMaxBytes, kToolChunk, true)};
  }
  static ToolTables open(const Hdf5File& file) {
    return {file.open_table("/tools/cycle", Hdf5Number::u64, 1),
            file.open_table("/tools/tool", Hdf5Number::u8, RecordedTool::kMaxBytes)};
  }
  void write(std::uint64_t row, const RecordedTool& of) {
    std::string text = of.tool;
    text.resize(RecordedTool::kMaxBytes, '\0');
    cycle.write(row, 1, &of.cycle);
    tool.write(row, 1, text.data());
  }
  RecordedTool read(std::uint64_t row) const {
    RecordedTool of;
    of.tool.resize(RecordedTool::kMaxBytes);
    cycle.read(row, 1, &of.cycle);
    tool.read(row, 1, of.tool.data());
    of.tool.resize(std::min(of.tool.find('\0'), of.tool.size()));
    return of;
  }
};

/// The tables of a group of a file that is being written, one for each quantity, and rows that wait to be written.
template <class Row>
class RowTables {
 public:
  RowTables(Hdf5File& file, const std::string& group, std::span<const RecordColumn<Row>> columns,
            std::uint64_t chunk_rows, bool compresses)
      : columns_(columns), chunk_rows_(chunk_rows) {
    file.make_group(group);
    for (const RecordColumn<Row>& column : columns_) {
      tables_.push_back(
          file.make_table(group + "/" + column.name, column.number, column.width, chunk_rows, compresses));
    }
    waiting_.resize(columns_.size());
  }

  void add(const Row& row) {
    for (std::size_t n = 0; n < columns_.size(); ++n) {
      const std::size_t end = waiting_[n].size();
      waiting_[n].resize(end + columns_[n].row_bytes);
      columns_[n].store(row, waiting_[n].data() + end);
    }
    ++waiting_rows_;
  }
  /// Forgets what waits, and goes on at a row that has been written already.
  void go_back_to(std::uint64_t row) {
    written_ = row;
    drop(waiting_rows_);
  }

  std::uint64_t written() const { return written_; }
  std::uint64_t waiting() const { return waiting_rows_; }
  /// As many of the rows that wait as end with a whole chunk.
  std::uint64_t whole_chunks() const {
    const std::uint64_t after = (written_ + waiting_rows_) / chunk_rows_ * chunk_rows_;
    return after > written_ ? after - written_ : 0;
  }

  /// Writes the first of the rows that wait.
  void write(std::uint64_t rows) {
    for (std::size_t n = 0; n < columns_.size(); ++n) tables_[n].write(written_, rows, waiting_[n].data());
    written_ += rows;
    drop(rows);
  }

 private:
  void drop(std::uint64_t rows) {
    for (std::size_t n = 0; n < columns_.size(); ++n) {
      const auto bytes = static_cast<std::ptrdiff_t>(rows * columns_[n].row_bytes);
      waiting_[n].erase(waiting_[n].begin(), waiting_[n].begin() + bytes);
    }
    waiting_rows_ -= rows;
  }

  std::span<const RecordColumn<Row>> columns_;
  std::vector<Hdf5Table> tables_;
  std::vector<std::vector<std::byte>> waiting_;
  std::uint64_t chunk_rows_;
  std::uint64_t written_ = 0;
  std::uint64_t waiting_rows_ = 0;
};

}  // namespace spinaltap
