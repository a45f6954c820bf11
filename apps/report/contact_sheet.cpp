#include "apps/report/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "apps/report/slice_marks.h"
#include "core/base/error.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

constexpr Colour kAmber{255, 196, 64};
constexpr Colour kGround{40, 44, 52};
constexpr int kGap = 6;
constexpr int kLabelHeight = 22;  // above each slice
constexpr int kScale = 2;         // of the letters

/// Tile size and scale, the same for all slices.
struct Layout {
  double pixel_mm;
  int width;
  int height;
  int columns;
  int rows;

  int tile_x(int n) const { return kGap + n % columns * (width + kGap); }
  int tile_y(int n) const { return kGap + n / columns * (height + kLabelHeight + kGap) + kLabelHeight; }
};

Layout layout_of(const GridGeometry& geometry, int slices, const ContactSheetOptions& options) {
  const double width_mm = geometry.size[0] * geometry.spacing_mm.x();
  const double height_mm = geometry.size[1] * geometry.spacing_mm.y();
  Layout layout{};
  layout.pixel_mm = std::max(width_mm, height_mm) / options.tile_pixels;
  // Long narrow slices still have room for their labels.
  const int min = std::min(options.tile_pixels, 210);
  layout.width = std::max(min, static_cast<int>(std::lround(width_mm / layout.pixel_mm)));
  layout.height = std::max(min / 2, static_cast<int>(std::lround(height_mm / layout.pixel_mm)));
  layout.columns = std::min(options.columns, slices);
  layout.rows = (slices + layout.columns - 1) / layout.columns;
  return layout;
}

/// A slice at the sheet's scale. Where a pixel covers several voxels it is their mean, so that noise does not alias.
Image slice_picture(const CtVolume& ct, int k, const Layout& layout, const HuWindow& window) {
  const GridGeometry& geometry = ct.geometry;
  const double voxel_mm = std::min(geometry.spacing_mm.x(), geometry.spacing_mm.y());
  const int fine = std::clamp(static_cast<int>(std::ceil(layout.pixel_mm / voxel_mm - 1e-6)), 1, 8);
  SliceFrame frame;
  frame.right = geometry.directions.col(0);
  frame.down = geometry.directions.col(1);
  frame.pixel_mm = layout.pixel_mm / fine;
  frame.width = layout.width * fine;
  frame.height = layout.height * fine;
  const Vec3 middle = geometry.to_patient(Vec3(0.5 * (geometry.size[0] - 1), 0.5 * (geometry.size[1] - 1), k));
  frame.origin_mm =
      middle - frame.pixel_mm * (0.5 * (frame.width - 1) * frame.right + 0.5 * (frame.height - 1) * frame.down);
  const Image picture = ct_slice(ct, frame, window).image;
  Image mean{layout.width, layout.height, {}};
  mean.rgb.resize(3 * static_cast<std::size_t>(layout.width) * static_cast<std::size_t>(layout.height));
  const auto wide = static_cast<std::size_t>(frame.width);
  for (int row = 0; row < layout.height; ++row) {
    for (int column = 0; column < layout.width; ++column) {
      int sum = 0;
      for (int n = 0; n < fine * fine; ++n) {
        const int y = row * fine + n / fine;
        const int x = column * fine + n % fine;
        sum += picture.rgb[3 * (static_cast<std::size_t>(y) * wide + static_cast<std::size_t>(x))];
      }
      fill_rectangle(mean, column, row, 1, 1, [&] {
        const auto grey = static_cast<std::uint8_t>((sum + fine * fine / 2) / (fine * fine));
        return Colour{grey, grey, grey};
      }());
    }
  }
  return mean;
}

}  // namespace

std::vector<int> contact_sheet_slices(int slices, int max) {
  std::vector<int> chosen;
  const int count = std::min(slices, max);
  chosen.reserve(static_cast<std::size_t>(count));
  for (int n = 0; n < count; ++n) {
    chosen.push_back(count > 1 ? static_cast<int>(std::lround(static_cast<double>(n) * (slices - 1) / (count - 1)))
                               : (slices - 1) / 2);
  }
  return chosen;
}

Image contact_sheet(const CtVolume& ct, const ContactSheetOptions& options) {
  check_geometry(ct.geometry, "CT");
  if (options.max_slices < 1 || options.max_slices > 100 || options.columns < 1 || options.tile_pixels < 64 ||
      options.tile_pixels > 1024) {
    fail("contact sheet: expected 1 to 100 slices, a column or more, and 64 to 1024 pixels a slice, found ",
         options.max_slices, ", ", options.columns, " and ", options.tile_pixels);
  }
  const std::vector<int> slices = contact_sheet_slices(ct.geometry.size[2], options.max_slices);
  const Layout layout = layout_of(ct.geometry, static_cast<int>(slices.size()), options);
  Image sheet{
      layout.columns * (layout.width + kGap) + kGap, layout.rows * (layout.height + kLabelHeight + kGap) + kGap, {}};
  sheet.rgb.resize(3 * static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height));
  fill_rectangle(sheet, 0, 0, sheet.width, sheet.height, kGround);
  for (std::size_t n = 0; n < slices.size(); ++n) {
    const int x = layout.tile_x(static_cast<int>(n));
    const int y = layout.tile_y(static_cast<int>(n));
    paste(slice_picture(ct, slices[n], layout, options.window), sheet, x, y);
    const double along_mm = ct.geometry.directions.col(2).dot(ct.geometry.to_patient(Vec3(0.0, 0.0, slices[n])));
    const std::string text = joined("k ", slices[n], "  ", orientation_letters(ct.geometry.directions.col(2)), " ",
                                    fixed_text(along_mm, 1), " mm");
    const int scale = pixel_text_width(text, kScale) <= layout.width ? kScale : 1;
    draw_text(sheet, x, y - kLabelHeight + 4, text, scale, kWhite);
    const PictureArea area{x, y, layout.width, layout.height};
    draw_side_letters(sheet, area, ct.geometry.directions.col(0), ct.geometry.directions.col(1), kScale, kAmber);
    draw_scale_bar(sheet, area, layout.pixel_mm);
  }
  return sheet;
}

}  // namespace spinaltap
