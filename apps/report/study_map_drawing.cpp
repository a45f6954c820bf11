#include "apps/report/study_map_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/report/square_map.h"
#include "apps/report/svg_parts.h"
#include "apps/report/text.h"

namespace spinaltap {
namespace {

constexpr double kDrawingWidth = 488.0;
constexpr double kSquaresSide = 300.0;
constexpr double kSquaresLeft = 52.0;
constexpr double kSquaresTop = 44.0;
constexpr double kDrawingHeight = kSquaresTop + kSquaresSide + 36.0;
constexpr std::size_t kFewRuns = 10;
constexpr int kLeastReach = 3, kMostReach = 8;  ///< cells to each side

/// From safe to bad.
struct Shade {
  double below;  ///< shares
  std::string_view colour, words;
};
constexpr std::array<Shade, 5> kShades{{{0.05, "#1b7837", "below 5 %"},
                                        {0.2, "#8fc98f", "5 to 20 %"},
                                        {0.5, "#fee08b", "20 to 50 %"},
                                        {0.8, "#fdae61", "50 to 80 %"},
                                        {2.0, "#e8603c", "80 % and more"}}};

const Shade& shade_of(double share) {
  return *std::find_if(kShades.begin(), kShades.end(), [share](const Shade& shade) { return share < shade.below; });
}

/// As far as cells of more than a few runs lie.
int reach_of(const StudyMap& map) {
  int reach = kLeastReach;
  for (const StudyMap::Cell& cell : map.cells) {
    if (cell.beyond_a.runs >= kFewRuns) reach = std::max({reach, std::abs(cell.medial), std::abs(cell.cranial)});
  }
  return std::min(reach, kMostReach);
}

std::string legend_svg() {
  constexpr double kRow = 20.0, kLegendLeft = kSquaresLeft + kSquaresSide + 16.0;
  double y = kSquaresTop + 12.0;
  std::string svg;
  for (const Shade& shade : kShades) {
    svg += svg_box(kLegendLeft, y - 11.0, 13.0, 13.0, svg_fill(shade.colour));
    svg += svg_text(kLegendLeft + 19.0, y, "start", shade.words);
    y += kRow;
  }
  svg += svg_text(kLegendLeft, y + 4.0, "start", "pale: fewer than");
  svg += svg_text(kLegendLeft, y + kRow, "start", std::to_string(kFewRuns) + " runs");
  return svg;
}

}  // namespace

std::string study_map_svg(const StudyMap& map) {
  std::map<std::pair<int, int>, const StudyShare*> cells;
  for (const StudyMap::Cell& cell : map.cells) cells[{cell.medial, cell.cranial}] = &cell.beyond_a;
  const int reach = reach_of(map);
  const auto at = [&](std::size_t medial, std::size_t cranial) {
    const auto cell = cells.find({static_cast<int>(medial) - reach, static_cast<int>(cranial) - reach});
    return cell == cells.end() ? nullptr : cell->second;
  };
  const bool is_entry = map.off == OffPlan::entry;
  SquareMap squares{
      kSquaresLeft, kSquaresTop, kSquaresSide, {}, is_entry ? "mm" : "degrees", [&at](std::size_t m, std::size_t c) {
        const StudyShare* const share = at(m, c);
        if (share == nullptr) return std::string();
        return svg_fill(shade_of(share->probability()).colour) +
               (share->runs < kFewRuns ? " fill-opacity=\"0.35\"" : "");
      }};
  squares.frames_none = true;
  for (int cell = -reach; cell <= reach; ++cell) squares.errors.push_back(StudyMap::kCell * cell);
  const std::string what = map.what == "all" ? "all screws" : map.what;
  const std::string title = std::string("Breach where the ") + (is_entry ? "entry" : "direction") + " lies, " + what;
  std::string svg = "<svg class=\"map\" role=\"img\" aria-label=\"" + escape_html(title) + "\" viewBox=\"0 0 " +
                    svg_number(kDrawingWidth) + " " + svg_number(kDrawingHeight) +
                    "\" font-size=\"13\" fill=\"#3d464e\">\n" +
                    svg_text(0.0, 14.0, "start", title, "font-weight=\"600\" font-size=\"15\" fill=\"#1a2026\"") +
                    svg_text(0.0, 32.0, "start", "% of the screws with any breach, off the plan by so much") +
                    square_map_svg(squares) + legend_svg();
  for (std::size_t cranial = 0; cranial < squares.errors.size(); ++cranial) {
    for (std::size_t medial = 0; medial < squares.errors.size(); ++medial) {
      const StudyShare* const share = at(medial, cranial);
      if (share == nullptr || share->runs < kFewRuns) continue;
      const std::string_view style = share->probability() < kShades.front().below ? "font-size=\"9\" fill=\"#fff\""
                                                                                  : "font-size=\"9\" fill=\"#1a2026\"";
      svg += svg_text(square_x(squares, medial), square_y(squares, cranial) + 3.5, "middle",
                      readable_number(100.0 * share->probability(), 0), style);
    }
  }
  return svg + "</svg>\n";
}

}  // namespace spinaltap
