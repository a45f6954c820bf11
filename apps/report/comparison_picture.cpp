#include "apps/report/comparison_picture.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include "apps/report/slice_marks.h"
#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/base/text_writer.h"
#include "core/surface/surface_samples.h"
#include "vdb/picture/render.h"

namespace spinaltap {
namespace {

constexpr int kTileWidth = 420;
constexpr int kTileHeight = 330;
constexpr int kTextScale = 2;
constexpr int kLine = (kTextHeight + 3) * kTextScale;
constexpr int kHead = 2 * kLine + 6;
constexpr int kTileGap = 8;
constexpr Colour kFigureColour{255, 190, 60};

struct Tile {
  const BoneModel* bone;
  std::string title;
  std::string figures;
};

std::string figures_text(const SurfaceFigures& figures, bool is_ground_truth) {
  std::string roughness = "ROUGHNESS " + fixed_text(figures.roughness_deg, 1);
  if (is_ground_truth) return roughness;
  return roughness + " VOLUME " + fixed_text(100.0 * figures.volume_change, 1) + " " + fixed_text(figures.mean_mm, 2) +
         " mm";
}

}  // namespace

Image comparison_picture(const Comparison& comparison, const Progress& progress) {
  if (comparison.surfaces.empty()) fail("comparison: nothing was compared");
  const PointMethod first = comparison.surfaces.front().method;
  const auto columns = static_cast<int>(std::count_if(comparison.surfaces.begin(), comparison.surfaces.end(),
                                                      [&](const auto& surface) { return surface.method == first; }));
  std::vector<Tile> tiles;
  for (const ComparedSurface& surface : comparison.surfaces) {
    const std::string name = upper_case(name_of(surface.method));
    tiles.push_back({surface.bone ? &*surface.bone : nullptr, joined(name, ", SMOOTHING ", surface.smoothing_mm, " mm"),
                     surface.bone ? figures_text(surface.figures, false) : "NO SURFACE"});
  }
  tiles.push_back({&comparison.ground_truth, "GROUND TRUTH", figures_text(comparison.ground_truth_figures, true)});
  const int rows = (static_cast<int>(tiles.size()) + columns - 1) / columns;
  Image sheet{columns * (kTileWidth + kTileGap) + kTileGap, rows * (kTileHeight + kHead + kTileGap) + kTileGap, {}};
  sheet.rgb.assign(3 * static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height), 24);
  for (std::size_t n = 0; n < tiles.size(); ++n) {
    const int x = kTileGap + static_cast<int>(n) % columns * (kTileWidth + kTileGap);
    const int y = kTileGap + static_cast<int>(n) / columns * (kTileHeight + kHead + kTileGap);
    draw_text(sheet, x, y, tiles[n].title, kTextScale, kWhite);
    draw_text(sheet, x, y + kLine, tiles[n].figures, kTextScale, kFigureColour);
    if (tiles[n].bone == nullptr) continue;
    const RenderOptions options{.width = kTileWidth, .height = kTileHeight, .from = Vec3(0.35, 1.0, 0.45)};
    paste(render_bone(*tiles[n].bone, options, progress), sheet, x, y + kHead);
  }
  return sheet;
}

}  // namespace spinaltap
