#pragma once

#include <optional>
#include <span>
#include <vector>

namespace spinaltap {

/// A JPEG picture of one component and one scan with nothing in it that its decoding does not need: tables, frame and
/// scan headers, the scan. Nothing for a stream that is not laid out as ISO/IEC 10918-1, annex B, has it: baseline,
/// extended or lossless, Huffman coded, one frame.
///
/// GDCM stops the program where bytes stand between two segments or an application segment is odd: Debian builds it
/// with assertions.
std::optional<std::vector<char>> plain_jpeg_stream(std::span<const char> bytes);

}  // namespace spinaltap
