#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/ct/detail/dicom_header.h"

namespace spinaltap {

/// Whether the transfer syntax `uid` is one that we read: plain, deflated, RLE, JPEG (baseline, extended, lossless),
/// JPEG-LS or JPEG 2000.
bool is_known_syntax(const std::string& uid);

/// Whether pixels of a known syntax come in fragments.
bool is_compressed_syntax(const std::string& uid);

/// "JPEG 2000, lossless", ...; the UID where it is not known.
std::string transfer_syntax_name(const std::string& uid);

/// What a frame takes when it is not compressed, bytes.
std::size_t frame_bytes(const DicomHeader& header);

/// The bytes that hold this frame's pixels, for encapsulated ones its fragments one after the other. Throws Error when
/// the file ends early.
std::vector<std::vector<char>> read_fragments(const DicomHeader& header);

/// Decompresses a frame: columns * rows values of bits_allocated bits, little endian. Throws Error for what cannot be
/// decoded and for codestreams of another size than the header says.
std::vector<char> decompress_frame(const DicomHeader& header);

}  // namespace spinaltap
