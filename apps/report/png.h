#pragma once

#include <string>
#include <string_view>

#include "core/base/image.h"

namespace spinaltap {

/// Bytes as base64 with padding and without line breaks (RFC 4648, section 4).
std::string base64(std::string_view bytes);

/// The image as a PNG file's bytes: 8-bit grey where all pixels are grey, else 8-bit RGB. Holds no time or text, so the
/// same image gives the same bytes. Throws Error on an empty image or one whose pixels do not fit its size.
std::string encode_png(const Image& image);

}  // namespace spinaltap
