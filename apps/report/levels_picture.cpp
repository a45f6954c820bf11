#include "apps/report/levels_picture.h"

#include <algorithm>
#include <sstream>

#include "apps/report/level_slices.h"
#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

constexpr int kPanelGap = 8;
constexpr int kCaptionHeight = kTextHeight + 6;
constexpr int kTitleHeight = 3 * kTextHeight + 8;
constexpr std::size_t kMaxLevelsAlone = 3;
constexpr const char* kOverviewTitle = "OVERVIEW";
constexpr double kSmallPixelMm = 0.5;  // of the axial slices of many levels

/// An image with room for words.
Image sheet_of(int width, int height) {
  Image sheet{width, height, {}};
  sheet.rgb.resize(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  fill_rectangle(sheet, 0, 0, width, height, kPictureGround);
  return sheet;
}

/// Slices below each other, each under its caption, all under a title.
Image stack_of(const std::vector<LevelSlice>& slices, const std::string& title, const Colour& colour) {
  int width = pixel_text_width(title, 3) + 2;
  int height = kTitleHeight;
  std::vector<Image> images;
  for (const LevelSlice& slice : slices) {
    images.push_back(framed(slice));
    width = std::max({width, images.back().width, pixel_text_width(slice.caption, 1) + 2});
    height += kCaptionHeight + images.back().height;
  }
  Image stack = sheet_of(width, height);
  draw_text(stack, 1, 3, title, 3, colour);
  int y = kTitleHeight;
  for (std::size_t n = 0; n < slices.size(); ++n) {
    draw_text(stack, 1, y + 3, slices[n].caption, 1, kWhite);
    paste(images[n], stack, 0, y + kCaptionHeight);
    y += kCaptionHeight + images[n].height;
  }
  return stack;
}

/// Images from left to right, their upper edges level.
Image side_by_side(const std::vector<Image>& images) {
  int width = -kPanelGap;
  int height = 0;
  for (const Image& image : images) {
    width += image.width + kPanelGap;
    height = std::max(height, image.height);
  }
  Image row = sheet_of(width, height);
  int x = 0;
  for (const Image& image : images) {
    paste(image, row, x, 0);
    x += image.width + kPanelGap;
  }
  return row;
}

/// Images in rows, as many columns as make the whole about `height` high.
Image grid_of(const std::vector<Image>& images, int height) {
  int tile_width = 0;
  int tile_height = 0;
  for (const Image& image : images) {
    tile_width = std::max(tile_width, image.width + kPanelGap);
    tile_height = std::max(tile_height, image.height + kPanelGap);
  }
  const auto count = static_cast<int>(images.size());
  const int max_rows = std::max(1, (height + kPanelGap) / tile_height);
  const int columns = (count + max_rows - 1) / max_rows;
  const int rows = (count + columns - 1) / columns;
  Image grid = sheet_of(columns * tile_width - kPanelGap, rows * tile_height - kPanelGap);
  for (int n = 0; n < count; ++n) {
    paste(images[static_cast<std::size_t>(n)], grid, n % columns * tile_width, n / columns * tile_height);
  }
  return grid;
}

/// Lines of at most `columns` letters, in capitals; words that are longer are cut.
std::vector<std::string> wrapped(const std::string& text, std::size_t columns) {
  std::istringstream words(text);
  std::vector<std::string> lines;
  for (std::string word; words >> word;) {
    word = upper_case(word);
    for (; !word.empty(); word.erase(0, columns)) {
      const std::string part = word.substr(0, columns);
      if (lines.empty() || lines.back().size() + 1 + part.size() > columns) {
        lines.push_back(part);
      } else {
        lines.back() += " " + part;
      }
    }
  }
  return lines;
}

struct ColouredLine {
  std::string text;
  Colour colour;
};

/// The names in short, then a line for each level that has warnings or is suspect.
Image words_below(const LevelSlices& slices, const LevelsPicture& what, int width) {
  constexpr int kLetter = 2;  // pixels a dot
  constexpr int kLineHeight = kTextHeight * kLetter + 6;
  const auto columns = static_cast<std::size_t>(std::max(8, width / (6 * kLetter)));
  std::vector<ColouredLine> lines;
  const auto add = [&](const std::string& text, const Colour& colour) {
    for (const std::string& line : wrapped(text, columns)) lines.push_back({line, colour});
  };
  std::string names;
  for (const PictureLevel& level : slices.levels()) names += (names.empty() ? "" : ", ") + slices.title(level);
  add(names, kWhite);
  if (what.seed_mm) add("cross: seed", kWhite);
  for (const PictureLevel& level : slices.levels()) {
    if (level.warnings.empty() && !level.suspect) continue;
    std::string text = slices.title(level);
    for (const std::string& warning : level.warnings)
      text += (&warning == level.warnings.data() ? ": " : ", ") + warning;
    if (level.warnings.empty()) text += ": suspect";
    add(text, slices.colour(level));
  }
  Image image = sheet_of(width, static_cast<int>(lines.size()) * kLineHeight);
  for (std::size_t n = 0; n < lines.size(); ++n) {
    draw_text(image, 1, static_cast<int>(n) * kLineHeight + 3, lines[n].text, kLetter, lines[n].colour);
  }
  return image;
}

}  // namespace

Image levels_picture(const CtVolume& ct, const LabelVolume& labels, const LevelsPicture& what) {
  const LevelSlices slices(ct, labels, what);
  std::vector<Image> panels;
  std::vector<Image> axials;
  const bool alone = what.chosen.has_value() || what.levels.size() <= kMaxLevelsAlone;
  for (const PictureLevel& level : slices.levels()) {
    const auto stack = [&](const std::vector<Plane>& planes, double pixel_mm) {
      std::vector<LevelSlice> shown;
      shown.reserve(planes.size());
      for (const Plane plane : planes) shown.push_back(slices.level_slice(plane, level, pixel_mm));
      return stack_of(shown, slices.title(level), slices.colour(level));
    };
    if (!alone) {
      axials.push_back(stack({Plane::kAxial}, std::max(what.pixel_mm, kSmallPixelMm)));
    } else if (!what.chosen || *what.chosen == level.label) {
      panels.push_back(stack({Plane::kAxial, Plane::kSagittal, Plane::kCoronal}, what.pixel_mm));
    }
  }
  std::vector<LevelSlice> overviews{slices.overview(Plane::kSagittal), slices.overview(Plane::kCoronal)};
  // Short ones stand below each other where there is room for it.
  const Image both = stack_of(overviews, kOverviewTitle, kWhite);
  if (alone && both.height <= panels.front().height) {
    panels.insert(panels.begin(), both);
  } else {
    panels.insert(panels.begin(),
                  {stack_of({overviews[0]}, kOverviewTitle, kWhite), stack_of({overviews[1]}, "", kWhite)});
  }
  if (!alone) panels.push_back(grid_of(axials, panels.front().height));
  const Image above = side_by_side(panels);
  const Image below = words_below(slices, what, above.width);
  Image picture = sheet_of(above.width + 2 * kPanelGap, above.height + below.height + 3 * kPanelGap);
  paste(above, picture, kPanelGap, kPanelGap);
  paste(below, picture, kPanelGap, above.height + 2 * kPanelGap);
  return picture;
}

}  // namespace spinaltap
