#include "apps/report/breach_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "apps/report/label_place.h"
#include "apps/report/square_map.h"
#include "apps/report/svg_parts.h"
#include "apps/report/text.h"

namespace spinaltap {
namespace {

constexpr double kWidth = 488.0;
constexpr double kSide = 112.0;  ///< of the map
constexpr double kMapLeft = 64.0;
constexpr double kMapTop = 24.0;
constexpr double kHeight = kMapTop + kSide + 33.0;
constexpr double kBarsLeft = kMapLeft + kSide + 50.0;

// From safe to bad; A in two: with over 1 mm of bone left, and with less.
constexpr std::string_view kFarInside = "#1b7837";
constexpr std::array<std::string_view, 5> kGrades{"#8fc98f", "#fee08b", "#fdae61", "#e8603c", "#a50026"};

std::string_view colour_of(double breach_mm) {
  if (breach_mm < -1.0) return kFarInside;
  return kGrades[static_cast<std::size_t>(gertzbein_robbins(std::max(0.0, breach_mm)))];
}

std::string map(const BreachLattice& lattice) {
  return square_map_svg(
      {kMapLeft, kMapTop, kSide, lattice.errors, "mm", [&lattice](std::size_t medial, std::size_t cranial) {
         return svg_fill(colour_of(lattice.at(medial, cranial)));
       }});
}

std::string bars(const GradeProbabilities& probabilities) {
  constexpr double kRow = 16.0;
  constexpr double kBar = 84.0;
  std::string svg;
  for (std::size_t n = 0; n < probabilities.grades.size(); ++n) {
    const double y = kMapTop + 4.0 + kRow * static_cast<double>(n);
    const double width = std::max(1.0, kBar * probabilities.grades[n].share);
    svg +=
        svg_text(kBarsLeft, y + 11.0, "start", std::string(1, letter_of(static_cast<Grade>(n))), "font-weight=\"600\"");
    svg += svg_box(kBarsLeft + 16.0, y, width, 12.0, kGrades[n]);
    svg += svg_text(kBarsLeft + 16.0 + kBar + 6.0, y + 11.0, "start", probability_in_words(probabilities.grades[n]));
  }
  const double below = kMapTop + 4.0 + kRow * 5.0;
  svg += svg_text(kBarsLeft, below + 10.0, "start", "into the canal " + probability_in_words(probabilities.canal));
  return svg;
}

/// "Errors: Robot, 726 screws", in two lines where it is longer than one.
std::vector<std::string> title_lines(const PlacedGrade& placed) {
  std::vector<std::string> lines{"Errors:"};
  const std::string title = placed.errors.title.empty() ? placed.errors.name : placed.errors.title;
  std::istringstream words(placed.registration ? title + "; with " + placed.registration->name : title);
  for (std::string word; words >> word;) {
    const bool fits = lines.size() == 2 || text_width(lines.back() + " " + word, 13.0) < kWidth - kBarsLeft;
    if (fits) {
      lines.back() += " " + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

}  // namespace

std::string breach_map_svg(const PlacedGrade& placed) {
  if (placed.map.shift_mm.errors.size() < 2) return {};
  constexpr std::string_view kHead = "font-weight=\"600\" font-size=\"14\" fill=\"#1a2026\"";
  std::string svg = "<svg class=\"map\" role=\"img\" aria-label=\"Breach by error of the entry\" viewBox=\"0 0 " +
                    svg_number(kWidth) + " " + svg_number(kHeight) + "\" font-size=\"13\" fill=\"#3d464e\">\n" +
                    svg_text(0.0, 14.0, "start", "Grade where the entry errs", kHead) +
                    svg_text(kBarsLeft, 14.0, "start", "Grades to expect, 95 % intervals", kHead) +
                    map(placed.map.shift_mm) + bars(placed.probabilities);
  double y = kMapTop + kSide + 12.0;
  for (const std::string& line : title_lines(placed)) {
    svg += svg_text(kBarsLeft, y, "start", line);
    y += 16.0;
  }
  return svg + "</svg>\n";
}

}  // namespace spinaltap
