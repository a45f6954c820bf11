#pragma once

#include "apps/report/pixel_text.h"
#include "core/base/geometry.h"
#include "core/base/image.h"

namespace spinaltap {

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
