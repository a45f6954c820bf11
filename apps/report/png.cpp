#include "apps/report/png.h"

#include <png.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {
namespace {

bool is_grey(const std::vector<std::uint8_t>& rgb) {
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    if (rgb[i] != rgb[i + 1] || rgb[i] != rgb[i + 2]) return false;
  }
  return true;
}

std::vector<std::uint8_t> grey_of(const std::vector<std::uint8_t>& rgb) {
  std::vector<std::uint8_t> grey(rgb.size() / 3);
  for (std::size_t i = 0; i < grey.size(); ++i) grey[i] = rgb[3 * i];
  return grey;
}

}  // namespace

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto byte = [&](std::size_t i) {
    return i < bytes.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) : 0U;
  };
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::uint32_t group = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    text += kDigits[group >> 18 & 63];
    text += kDigits[group >> 12 & 63];
    text += i + 1 < bytes.size() ? kDigits[group >> 6 & 63] : '=';
    text += i + 2 < bytes.size() ? kDigits[group & 63] : '=';
  }
  return text;
}

std::string encode_png(const Image& image) {
  if (image.width < 1 || image.height < 1) {
    fail("picture: expected at least 1 x 1 pixels, found ", image.width, " x ", image.height);
  }
  const std::size_t expected =
      std::size_t{3} * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.rgb.size() != expected) fail("picture: expected ", expected, " bytes, found ", image.rgb.size());

  // A CT slice is grey: a third of the bytes says the same.
  const bool grey = is_grey(image.rgb);
  const std::vector<std::uint8_t> pixels = grey ? grey_of(image.rgb) : image.rgb;
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = grey ? PNG_FORMAT_GRAY : PNG_FORMAT_RGB;

  // Room for any picture of its size: to ask how much this one takes is to encode it twice.
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string file(bytes, '\0');
  if (png_image_write_to_memory(&header, file.data(), &bytes, 0, pixels.data(), 0, nullptr) == 0) {
    fail("picture cannot be written as PNG: ", header.message);
  }
  file.resize(bytes);
  return file;
}

}  // namespace spinaltap
