#include "apps/report/slice_marks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>

#include "apps/report/slice_frame.h"
#include "core/base/text_fields.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

constexpr int kGlyphWidth = 5;
constexpr int kAdvance = 6;

struct Glyph {
  char letter;
  std::array<std::uint8_t, kTextHeight> rows;  ///< of five dots, the leftmost in bit 4
};

constexpr std::array<Glyph, 50> kFont{{
    {'0', {0x0E, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0E}}, {'1', {0x04, 0x0C, 0x04, 0x04, 0x04, 0x04, 0x0E}},
    {'2', {0x0E, 0x11, 0x01, 0x02, 0x04, 0x08, 0x1F}}, {'3', {0x1F, 0x02, 0x04, 0x02, 0x01, 0x11, 0x0E}},
    {'4', {0x02, 0x06, 0x0A, 0x12, 0x1F, 0x02, 0x02}}, {'5', {0x1F, 0x10, 0x1E, 0x01, 0x01, 0x11, 0x0E}},
    {'6', {0x06, 0x08, 0x10, 0x1E, 0x11, 0x11, 0x0E}}, {'7', {0x1F, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08}},
    {'8', {0x0E, 0x11, 0x11, 0x0E, 0x11, 0x11, 0x0E}}, {'9', {0x0E, 0x11, 0x11, 0x0F, 0x01, 0x02, 0x0C}},
    {'A', {0x0E, 0x11, 0x11, 0x11, 0x1F, 0x11, 0x11}}, {'B', {0x1E, 0x11, 0x11, 0x1E, 0x11, 0x11, 0x1E}},
    {'C', {0x0E, 0x11, 0x10, 0x10, 0x10, 0x11, 0x0E}}, {'D', {0x1C, 0x12, 0x11, 0x11, 0x11, 0x12, 0x1C}},
    {'E', {0x1F, 0x10, 0x10, 0x1E, 0x10, 0x10, 0x1F}}, {'F', {0x1F, 0x10, 0x10, 0x1E, 0x10, 0x10, 0x10}},
    {'G', {0x0E, 0x11, 0x10, 0x17, 0x11, 0x11, 0x0F}}, {'H', {0x11, 0x11, 0x11, 0x1F, 0x11, 0x11, 0x11}},
    {'I', {0x0E, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0E}}, {'J', {0x07, 0x02, 0x02, 0x02, 0x02, 0x12, 0x0C}},
    {'K', {0x11, 0x12, 0x14, 0x18, 0x14, 0x12, 0x11}}, {'L', {0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x1F}},
    {'M', {0x11, 0x1B, 0x15, 0x15, 0x11, 0x11, 0x11}}, {'N', {0x11, 0x11, 0x19, 0x15, 0x13, 0x11, 0x11}},
    {'O', {0x0E, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0E}}, {'P', {0x1E, 0x11, 0x11, 0x1E, 0x10, 0x10, 0x10}},
    {'Q', {0x0E, 0x11, 0x11, 0x11, 0x15, 0x12, 0x0D}}, {'R', {0x1E, 0x11, 0x11, 0x1E, 0x14, 0x12, 0x11}},
    {'S', {0x0F, 0x10, 0x10, 0x0E, 0x01, 0x01, 0x1E}}, {'T', {0x1F, 0x04, 0x04, 0x04, 0x04, 0x04, 0x04}},
    {'U', {0x11, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0E}}, {'V', {0x11, 0x11, 0x11, 0x11, 0x11, 0x0A, 0x04}},
    {'W', {0x11, 0x11, 0x11, 0x15, 0x15, 0x15, 0x0A}}, {'X', {0x11, 0x11, 0x0A, 0x04, 0x0A, 0x11, 0x11}},
    {'Y', {0x11, 0x11, 0x11, 0x0A, 0x04, 0x04, 0x04}}, {'Z', {0x1F, 0x01, 0x02, 0x04, 0x08, 0x10, 0x1F}},
    {'m', {0x00, 0x00, 0x1A, 0x15, 0x15, 0x11, 0x11}}, {'k', {0x10, 0x10, 0x12, 0x14, 0x18, 0x14, 0x12}},
    {'-', {0x00, 0x00, 0x00, 0x1F, 0x00, 0x00, 0x00}}, {'.', {0x00, 0x00, 0x00, 0x00, 0x00, 0x0C, 0x0C}},
    {',', {0x00, 0x00, 0x00, 0x00, 0x0C, 0x04, 0x08}}, {'/', {0x00, 0x01, 0x02, 0x04, 0x08, 0x10, 0x00}},
    {':', {0x00, 0x0C, 0x0C, 0x00, 0x0C, 0x0C, 0x00}}, {'?', {0x0E, 0x11, 0x01, 0x02, 0x04, 0x00, 0x04}},
    {'(', {0x02, 0x04, 0x08, 0x08, 0x08, 0x04, 0x02}}, {')', {0x08, 0x04, 0x02, 0x02, 0x02, 0x04, 0x08}},
    {'%', {0x18, 0x19, 0x02, 0x04, 0x08, 0x13, 0x03}}, {'\'', {0x04, 0x04, 0x08, 0x00, 0x00, 0x00, 0x00}},
    {'+', {0x00, 0x04, 0x04, 0x1F, 0x04, 0x04, 0x00}}, {'=', {0x00, 0x00, 0x1F, 0x00, 0x1F, 0x00, 0x00}},
}};

const Glyph* find_glyph(char letter) {
  const auto known = [](char c) {
    return std::find_if(kFont.begin(), kFont.end(), [c](const Glyph& glyph) { return glyph.letter == c; });
  };
  auto glyph = known(letter);
  if (glyph == kFont.end()) glyph = known(upper_case({&letter, 1}).front());
  return glyph != kFont.end() ? &*glyph : nullptr;
}

void draw_dots(Image& image, int x, int y, std::string_view text, int scale, int rim, const Colour& colour) {
  for (const char letter : text) {
    const Glyph* glyph = find_glyph(letter);
    for (int row = 0; glyph != nullptr && row < kTextHeight; ++row) {
      for (int column = 0; column < kGlyphWidth; ++column) {
        if ((glyph->rows[static_cast<std::size_t>(row)] >> (kGlyphWidth - 1 - column) & 1) == 0) continue;
        fill_rectangle(image, x + column * scale - rim, y + row * scale - rim, scale + 2 * rim, scale + 2 * rim,
                       colour);
      }
    }
    x += kAdvance * scale;
  }
}

}  // namespace

int pixel_text_width(std::string_view text, int scale) {
  return text.empty() ? 0 : (static_cast<int>(text.size()) * kAdvance - (kAdvance - kGlyphWidth)) * scale;
}

void draw_text(Image& image, int x, int y, std::string_view text, int scale, const Colour& colour) {
  draw_dots(image, x, y, text, scale, 1, {0, 0, 0});
  draw_dots(image, x, y, text, scale, 0, colour);
}

void fill_rectangle(Image& image, int x, int y, int width, int height, const Colour& colour) {
  for (int row = std::max(y, 0); row < std::min(y + height, image.height); ++row) {
    for (int column = std::max(x, 0); column < std::min(x + width, image.width); ++column) {
      const std::size_t at = 3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                                  static_cast<std::size_t>(column));
      std::copy(colour.begin(), colour.end(), image.rgb.begin() + static_cast<std::ptrdiff_t>(at));
    }
  }
}

void paste(const Image& part, Image& whole, int x, int y) {
  for (int row = 0; row < part.height; ++row) {
    std::copy_n(part.rgb.begin() + std::ptrdiff_t{3} * row * part.width, std::ptrdiff_t{3} * part.width,
                whole.rgb.begin() + 3 * (static_cast<std::ptrdiff_t>(y + row) * whole.width + x));
  }
}

void draw_side_letters(Image& image, const PictureArea& area, const Vec3& right, const Vec3& down, int scale,
                       const Colour& colour) {
  const int height = kTextHeight * scale;
  const auto at = [&](const Vec3& direction, double across, double along) {
    const std::string letters = orientation_letters(direction);
    const int width = pixel_text_width(letters, scale);
    draw_text(image, area.x + 4 + static_cast<int>(std::lround(across * (area.width - width - 8))),
              area.y + 4 + static_cast<int>(std::lround(along * (area.height - height - 8))), letters, scale, colour);
  };
  at(-right, 0.0, 0.5);
  at(right, 1.0, 0.5);
  at(-down, 0.5, 0.0);
  at(down, 0.5, 1.0);
}

double round_bar_mm(double length_mm) {
  const double wanted_mm = 0.25 * length_mm;
  const double ten_mm = std::pow(10.0, std::floor(std::log10(wanted_mm)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * ten_mm <= wanted_mm) return factor * ten_mm;
  }
  return ten_mm;
}

void draw_scale_bar(Image& image, const PictureArea& area, double pixel_mm) {
  const double bar_mm = round_bar_mm(area.width * pixel_mm);
  const int width = static_cast<int>(std::lround(bar_mm / pixel_mm));
  const int bottom = area.y + area.height - 6;
  fill_rectangle(image, area.x + 5, bottom - 4, width + 2, 5, {0, 0, 0});
  fill_rectangle(image, area.x + 6, bottom - 3, width, 3, kWhite);
  draw_text(image, area.x + 6, bottom - 8 - kTextHeight, short_text(bar_mm) + " mm", 1, kWhite);
}

void draw_cross(Image& image, int x, int y) {
  constexpr int kArm = 7;
  constexpr int kHole = 3;  // from the middle to where an arm begins
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return;
  for (const int rim : {1, 0}) {
    const Colour colour = rim == 1 ? Colour{0, 0, 0} : kWhite;
    const int length = kArm - kHole + 1 + 2 * rim;
    const int thick = 1 + 2 * rim;
    fill_rectangle(image, x - kArm - rim, y - rim, length, thick, colour);
    fill_rectangle(image, x + kHole - rim, y - rim, length, thick, colour);
    fill_rectangle(image, x - rim, y - kArm - rim, thick, length, colour);
    fill_rectangle(image, x - rim, y + kHole - rim, thick, length, colour);
  }
}

}  // namespace spinaltap
