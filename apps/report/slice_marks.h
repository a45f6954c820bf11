#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/base/geometry.h"
#include "core/base/image.h"

namespace spinaltap {

using Colour = std::array<std::uint8_t, 3>;

constexpr Colour kWhite{255, 255, 255};

/// Height of capitals and digits drawn by draw_text(), pixels at scale 1. Letters stand 6 pixels apart.
constexpr int kTextHeight = 7;

/// Width of a text in pixels.
int pixel_text_width(std::string_view text, int scale);

/// Draws text in a font of 5 x 7 dots, each `scale` pixels wide, its upper left corner at (x, y), on a dark rim that
/// keeps it legible on any ground. Letters are capitals, but for a small m and k of units; what the font does not have
/// is left blank, and what does not fit the picture is cut.
void draw_text(Image& image, int x, int y, std::string_view text, int scale, const Colour& colour);

/// Fills a rectangle, as much of it as lies in the picture.
void fill_rectangle(Image& image, int x, int y, int width, int height, const Colour& colour);

/// Copies a picture into another, its upper left corner to (x, y); it must lie within.
void paste(const Image& part, Image& whole, int x, int y);

/// Part of a picture, pixels.
struct PictureArea {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

/// Letters in the middle of the four edges: towards which side of the patient the picture goes there. `right`, `down`:
/// the directions of its columns and rows, patient LPS.
void draw_side_letters(Image& image, const PictureArea& area, const Vec3& right, const Vec3& down, int scale,
                       const Colour& colour);

/// 1, 2 or 5 times a power of ten, the largest that is at most a quarter of a length.
double round_bar_mm(double length_mm);

/// A bar of round_bar_mm() of the area's width in its lower left corner, and its length in words above it. The bar is
/// as many pixels long as it says, to half a pixel.
void draw_scale_bar(Image& image, const PictureArea& area, double pixel_mm);

/// A small upright cross, open in the middle so that it does not hide what it marks: white on black, legible on any
/// ground. Nothing when (x, y) lies outside the picture.
void draw_cross(Image& image, int x, int y);

}  // namespace spinaltap
