#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/ct/detail/dicom_bytes.h"

namespace spinaltap {

/// One data element of a DICOM file: where its value lies.
struct DicomElement {
  std::uint32_t tag = 0;     ///< group in the upper 16 bits, element in the lower
  std::uint32_t length = 0;  ///< of the value, bytes
  bool undefined_length = false;
  bool implicit_inside = false;  ///< items hold no value representations
  bool is_bytes = false;         ///< value representation OB: bytes, which big endian files do not swap
  std::uint64_t offset = 0;      ///< of the value, bytes from the start of the file, or of the inflated data set
};

/// A stretch of a file, or of its inflated data set.
struct ByteRange {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
};

/// Encapsulated pixels (PS3.5, A.4).
struct DicomFragments {
  std::uint64_t start = 0;               ///< where the first fragment's item begins
  std::vector<std::uint32_t> frames_at;  ///< the offset table: where frames begin, bytes from `start`; may be empty
  std::vector<ByteRange> fragments;
};

/// Walks the top level of a DICOM file (PS3.5, 7.1) of any byte order and checks that every length lies within it.
///
/// GDCM's own parser is not given files: Debian builds it with assertions, so that one cut short ends the whole
/// program, and it fills missing pixels with what memory holds.
class DicomElementWalker {
 public:
  /// Whether the file can be opened and has the mark "DICM" after its first 128 bytes, as every DICOM file has, or
  /// begins with a data set at once, as old programs write it.
  bool open(const std::filesystem::path& file);
  bool has_preamble() const { return has_preamble_; }
  /// Of a file that names no transfer syntax: the one of plain pixels that its elements show.
  std::string plain_syntax() const;

  /// Says how the elements behind group 0002 are stored; call it where TransferSyntaxUID stands.
  void set_transfer_syntax(std::string_view uid);

  /// The next element, the file's own group 0002 first; false at the end of the file. Throws Error where the structure
  /// is broken or the file ends early.
  bool next(DicomElement& element);

  /// Passes over the value of `element`, which next() just gave.
  void skip(const DicomElement& element);

  /// The value of `element`, at most `max_bytes` of it, and passes over it.
  std::string value(const DicomElement& element, std::uint32_t max_bytes = 4096);

  /// Calls `visit` for each element of each item of the sequence `element`; `visit` passes over it, by any of the
  /// functions here.
  void items(const DicomElement& element, const std::function<void(std::size_t item, const DicomElement&)>& visit);

  /// Encapsulated pixels, which next() just gave.
  DicomFragments fragments();

  bool is_big_endian() const { return big_endian_; }
  /// Whether offsets count inflated bytes, which begin at data_set_offset() of the file.
  bool is_deflated() const { return deflated_ && past_meta_; }
  std::uint64_t data_set_offset() const { return data_set_offset_; }

 private:
  [[noreturn]] void fail_short() const;
  void read(char* bytes, std::uint64_t count);
  void begin_data_set();
  void move_to(std::uint64_t position);
  std::uint16_t read_u16();
  std::uint32_t read_u32();
  std::uint32_t read_tag();
  DicomElement read_element(bool implicit);
  void skip_sequence(bool implicit, int depth);
  void skip_item(bool implicit, int depth);

  std::filesystem::path file_;
  DicomBytes bytes_;
  std::uint64_t data_set_offset_ = 0;
  bool has_preamble_ = false;
  bool past_meta_ = false;
  bool deflated_ = false;
  bool implicit_ = false;
  bool big_endian_ = false;
};

}  // namespace spinaltap
