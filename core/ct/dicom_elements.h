#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace spinaltap {

/// One data element of a DICOM file: where its value lies.
struct DicomElement {
  std::uint32_t tag = 0;     ///< group in the upper 16 bits, element in the lower
  std::uint32_t length = 0;  ///< of the value, bytes
  bool undefined_length = false;
  bool implicit_inside = false;  ///< items hold no value representations
  std::uint64_t offset = 0;      ///< of the value, bytes from the start of the file
};

/// A stretch of a file.
struct ByteRange {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
};

/// Walks the top level of a little endian DICOM file (PS3.5, 7.1) and checks that every length lies within the file.
///
/// GDCM's own parser is not given files: Debian builds it with assertions, so that one cut short ends the whole
/// program, and it fills missing pixels with what memory holds.
class DicomElementWalker {
 public:
  /// Whether the file can be opened and has the mark "DICM" after its first 128 bytes, as every DICOM file has.
  bool open(const std::filesystem::path& file);

  /// The next element, the file's own group 0002 first; false at the end of the file. Throws Error where the structure
  /// is broken or the file ends early.
  bool next(DicomElement& element);

  /// Passes over the value of `element`, which next() just gave.
  void skip(const DicomElement& element);

  /// The value of `element`, at most `max_bytes` of it, and passes over it.
  std::string value(const DicomElement& element, std::uint32_t max_bytes = 4096);

  /// The fragments of encapsulated pixels, without the offset table before them.
  std::vector<ByteRange> fragments();

 private:
  [[noreturn]] void fail_short() const;
  std::uint64_t left() const { return size_ - position_; }
  void read(void* bytes, std::uint64_t count);
  void seek(std::uint64_t position);
  std::uint16_t read_u16();
  std::uint32_t read_u32();
  std::uint32_t read_tag();
  DicomElement read_element(bool implicit);
  void skip_sequence(bool implicit, int depth);
  void skip_item(bool implicit, int depth);

  std::filesystem::path file_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;
  bool past_meta_ = false;
  bool implicit_ = false;
};

}  // namespace spinaltap
