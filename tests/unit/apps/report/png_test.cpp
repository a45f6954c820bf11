#include <gtest/gtest.h>
#include <png.h>

#include "apps/report/png.h"
#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

// RFC 4648, section 10.
TEST(Base64, MatchesTheTestVectorsOfItsStandard) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(Base64, TakesBytesAbove127AndZeros) { EXPECT_EQ(base64(std::string_view("\xFF\xFE\x00\xFB", 4)), "//4A+w=="); }

Image noise(int width, int height, bool grey) {
  Image image{width, height, {}};
  for (int i = 0; i < width * height * 3; ++i) {
    const auto index = static_cast<std::uint64_t>(grey ? i / 3 : i);
    image.rgb.push_back(static_cast<std::uint8_t>(256.0 * random_uniform(20, index)));
  }
  return image;
}

Image decode(const std::string& file) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&header, file.data(), file.size()), 0) << header.message;
  header.format = PNG_FORMAT_RGB;
  Image image{static_cast<int>(header.width), static_cast<int>(header.height), {}};
  image.rgb.resize(PNG_IMAGE_SIZE(header));
  EXPECT_NE(png_image_finish_read(&header, nullptr, image.rgb.data(), 0, nullptr), 0) << header.message;
  return image;
}

TEST(Png, DecodesToTheSamePixelsInColourAndInGrey) {
  for (const bool grey : {false, true}) {
    const Image image = noise(37, 23, grey);
    const Image decoded = decode(encode_png(image));
    EXPECT_EQ(decoded.width, 37);
    EXPECT_EQ(decoded.height, 23);
    EXPECT_EQ(decoded.rgb, image.rgb);
  }
}

TEST(Png, IsTheSameForTheSameImage) { EXPECT_EQ(encode_png(noise(64, 64, false)), encode_png(noise(64, 64, false))); }

TEST(Png, StoresGreyPicturesInOneChannel) {
  // Noise does not compress, so the file's size is that of its channels.
  EXPECT_LT(2 * encode_png(noise(64, 64, true)).size(), encode_png(noise(64, 64, false)).size());
}

TEST(Png, RejectsEmptyImagesAndWrongSizes) {
  EXPECT_THROW(encode_png({}), Error);
  EXPECT_THROW(encode_png({2, 2, std::vector<std::uint8_t>(11)}), Error);
}

}  // namespace

}  // namespace spinaltap
