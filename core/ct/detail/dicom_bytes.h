#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>

namespace spinaltap {

/// Reads a file from front to back; from a given place on, optionally, what its deflated bytes inflate to (PS3.5, A.5).
/// Inflated bytes are never held as a whole, so a file that would inflate to a thousand times its size costs no memory.
class DicomBytes {
 public:
  DicomBytes();
  ~DicomBytes();
  DicomBytes(const DicomBytes&) = delete;
  DicomBytes& operator=(const DicomBytes&) = delete;

  /// False where the file cannot be opened or is no regular file.
  bool open(const std::filesystem::path& file);
  /// What follows is raw deflate; positions start again at 0.
  void inflate_from_here();

  std::uint64_t position() const { return position_; }
  bool at_end();
  /// Whether `count` more bytes may follow. Certain for plain bytes; for deflated ones an upper bound.
  bool may_hold(std::uint64_t count) const;
  /// The next `count` bytes; false where there are fewer.
  bool read(char* bytes, std::uint64_t count);
  /// As read(), without going on. `count`: up to 16.
  bool peek(char* bytes, std::uint64_t count);
  bool skip(std::uint64_t count);
  /// Goes back to the file's begin; not for deflated bytes.
  bool rewind();

 private:
  struct Inflater;
  bool read_plain(char* bytes, std::uint64_t count);

  std::ifstream stream_;
  std::uint64_t size_ = 0;  ///< of the file
  std::uint64_t position_ = 0;
  std::unique_ptr<Inflater> inflater_;
};

}  // namespace spinaltap
