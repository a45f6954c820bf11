#include "apps/report/slice_marks.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "apps/report/slice_frame.h"

namespace spinaltap {

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
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g mm", bar_mm);
  const int bottom = area.y + area.height - 6;
  fill_rectangle(image, area.x + 5, bottom - 4, width + 2, 5, {0, 0, 0});
  fill_rectangle(image, area.x + 6, bottom - 3, width, 3, kWhite);
  draw_text(image, area.x + 6, bottom - 8 - kTextHeight, text.data(), 1, kWhite);
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
