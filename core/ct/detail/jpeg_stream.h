#pragma once

#include <optional>
#include <span>
#include <vector>

namespace spinaltap {

/// What compressed pixels say of themselves.
struct CodestreamSize {
  long long columns = 0;
  long long rows = 0;
  int components = 0;               ///< values a pixel
  int bits = 0;                     ///< of a value
  std::optional<bool> is_signed{};  ///< JPEG 2000 says so; the others do not
};

/// Reads the frame header of JPEG, JPEG-LS or JPEG 2000 pixels; nothing where there is none.
///
/// GDCM's decoders write past the end of their buffers when a codestream is of another size than the file's header
/// says: compare first. Sources: ISO/IEC 10918-1, B.2.2; 14495-1, C.2.2; 15444-1, A.5.1.
std::optional<CodestreamSize> codestream_size(std::span<const char> bytes);

/// A JPEG picture of one component and one scan with nothing in it that its decoding does not need: tables, frame and
/// scan headers, the scan. Nothing for a stream that is not laid out as ISO/IEC 10918-1, annex B, has it: baseline,
/// extended or lossless, Huffman coded, one frame.
///
/// GDCM stops the program where bytes stand between two segments or an application segment is odd: Debian builds it
/// with assertions.
std::optional<std::vector<char>> plain_jpeg_stream(std::span<const char> bytes);

}  // namespace spinaltap
