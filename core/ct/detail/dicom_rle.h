#pragma once

#include <span>

namespace spinaltap {

/// Decodes DICOM's run lengths (PS3.5, annex G) of one grey frame: `bytes_per_value` segments, the most significant
/// byte's first, into little endian values. False where the stream is broken or does not fill `values` just so.
///
/// GDCM has this too, but stops the program where a segment is broken: Debian builds it with assertions.
bool decode_dicom_rle(std::span<const char> stream, int bytes_per_value, std::span<char> values);

}  // namespace spinaltap
