#pragma once

#include <string>
#include <vector>

#include "core/session/record/detail/record_columns.h"
#include "core/session/record/detail/record_layout.h"

namespace spinaltap {

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
