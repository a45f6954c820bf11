#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct gzFile_s;  // zlib's

namespace spinaltap {

/// Reads a regular file from front to back in bounded memory. One whose name ends in .gz is unpacked on the way.
///
/// Views that it gives hold until the next call. All throw Error, naming the file, where it cannot be read or its gzip
/// stream is damaged or cut short.
class FileReader {
 public:
  /// Throws Error when the file is missing, not a regular file, or gzip although its name says otherwise (and vice
  /// versa).
  explicit FileReader(const std::filesystem::path& path);

  /// The next line, without its end (\n or \r\n); false when there is none. Throws Error when it is over 1 MiB.
  bool line(std::string_view& text);

  /// The next `count` bytes, up to 1 MiB; false when there are fewer.
  bool bytes(std::size_t count, std::string_view& data) {
    if (!has(count)) return false;
    data = {buffer_.data() + begin_, count};
    begin_ += count;
    return true;
  }

  /// Leaves out `count` bytes; false when there are fewer.
  bool skip(std::uint64_t count);

  /// No more bytes than this are left: exact in a plain file, far too many in a packed one.
  std::uint64_t max_bytes_left() const { return max_bytes_ - std::min(read_, max_bytes_) + (end_ - begin_); }

  /// The file's name, for messages.
  const std::string& name() const { return name_; }

 private:
  struct Close {
    void operator()(gzFile_s* file) const;
  };

  /// Whether the buffer holds the next `count` bytes; reads more of them where it does not.
  bool has(std::size_t count) { return end_ - begin_ >= count || fill(count); }
  bool fill(std::size_t count);

  std::string name_;
  std::unique_ptr<gzFile_s, Close> file_;
  std::uint64_t max_bytes_ = 0;  ///< of the unpacked file
  std::uint64_t read_ = 0;       ///< bytes taken into the buffer so far
  std::string buffer_;
  std::size_t begin_ = 0;  ///< of what is not given out yet
  std::size_t end_ = 0;
};

/// The lines of a text file that is read from its beginning, counted for messages.
class TextLines {
 public:
  explicit TextLines(FileReader& file) : file_(file) {}

  /// The next line; false when there is none.
  bool next(std::string_view& line);
  /// The next one that is more than blanks.
  bool next_filled(std::string_view& line);
  /// "points.csv, line 12": the last line read.
  std::string place() const;

 private:
  FileReader& file_;
  std::uint64_t number_ = 0;
};

/// Writes a file from front to back, piece by piece, for content that is too large to hold twice. `path` is a staged
/// (temporary) name: without close() half a file stays there. Throws Error when the disk is full.
class FileWriter {
 public:
  explicit FileWriter(const std::filesystem::path& path);

  void write(std::string_view bytes);
  /// The numbers' bytes as they stand in memory.
  void write(std::span<const double> numbers);

  /// Call last: only then do all bytes have their place on the disk.
  void close();

 private:
  void check() const;

  std::filesystem::path path_;
  std::ofstream file_;
};

}  // namespace spinaltap
