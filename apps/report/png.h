#pragma once

#include <string>

#include "core/base/image.h"

namespace spinaltap {

/// The image as a PNG file's bytes: 8-bit grey where all pixels are grey, else 8-bit RGB. Holds no time or text, so the
/// same image gives the same bytes. Throws Error on an empty image or one whose pixels do not fit its size.
std::string encode_png(const Image& image);

}  // namespace spinaltap
