#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace spinaltap {

/// The part of HDF5 that records need: tables of numbers that grow, texts beside them, and files that can be read while
/// they are written (HDF5's "single writer, multiple readers"). Everything throws Error, with the file's name and
/// HDF5's words, and prints nothing.
enum class Hdf5Number { u8, u32, u64, i64, f32, f64 };

/// How many numbers a row has: one, a line of them, or an array.
class Hdf5Row {
 public:
  Hdf5Row(std::uint64_t width) : shape_(width == 1 ? std::vector<std::uint64_t>() : std::vector{width}) {}
  static Hdf5Row array(std::vector<std::uint64_t> shape) {
    Hdf5Row row(1);
    row.shape_ = std::move(shape);
    return row;
  }
  /// Empty where it is one.
  const std::vector<std::uint64_t>& shape() const { return shape_; }
  std::uint64_t numbers() const {
    std::uint64_t count = 1;
    for (const std::uint64_t side : shape_) count *= side;
    return count;
  }

 private:
  std::vector<std::uint64_t> shape_;
};

/// Rows of numbers, each of the same shape. Belongs to the file that made or opened it, which must outlive it.
class Hdf5Table {
 public:
  /// None yet.
  Hdf5Table() = default;

  std::uint64_t rows() const;
  /// Bytes that a row takes in memory.
  std::size_t row_bytes() const { return row_bytes_; }
  /// Writes rows `first` to `first + count - 1`, which may lie beyond the end; numbers as they stand in memory.
  void write(std::uint64_t first, std::uint64_t count, const void* numbers);
  /// Throws Error where they are not all there.
  void read(std::uint64_t first, std::uint64_t count, void* numbers) const;

 private:
  friend class Hdf5File;
  struct Handle;
  explicit Hdf5Table(Handle handle);
  std::shared_ptr<Handle> handle_;
  std::size_t row_bytes_ = 0;
};

class Hdf5File {
 public:
  /// Makes a file, which must not exist.
  static Hdf5File create(const std::filesystem::path& path);
  /// Opens one for reading, also one that is being written or whose writer was killed.
  static Hdf5File open(const std::filesystem::path& path);
  ~Hdf5File();
  Hdf5File(Hdf5File&&) noexcept;
  Hdf5File& operator=(Hdf5File&&) noexcept;

  /// `name` as in "/cycles".
  void make_group(const std::string& name);
  void write_text(const std::string& group, const std::string& name, const std::string& text);
  /// All texts of a group.
  std::map<std::string, std::string> read_texts(const std::string& group) const;

  /// A table that grows, in chunks of `chunk_rows`, each with a checksum and, where asked, compressed.
  Hdf5Table make_table(const std::string& name, Hdf5Number number, const Hdf5Row& row, std::uint64_t chunk_rows,
                       bool compresses);
  /// A table of one row of zeros, in one place of the file.
  Hdf5Table make_row(const std::string& name, Hdf5Number number, const Hdf5Row& row);
  /// Throws Error where it is missing or of another kind.
  Hdf5Table open_table(const std::string& name, Hdf5Number number, const Hdf5Row& row) const;
  /// Whether there is a group or a table of this name, as in "/cycles".
  bool has(const std::string& name) const;

  /// From now on others may read along: nothing can be made any more, only tables grow.
  void let_others_read();
  /// Hands everything to the operating system.
  void flush();
  /// Throws Error where that fails; the file is let go all the same.
  void close();

 private:
  struct Handle;
  explicit Hdf5File(std::unique_ptr<Handle> handle);
  std::unique_ptr<Handle> handle_;
};

}  // namespace spinaltap
