#include "apps/report/square_map.h"

#include <algorithm>
#include <cmath>

#include "apps/report/svg_parts.h"
#include "apps/report/text.h"

namespace spinaltap {
namespace {

double cell_of(const SquareMap& map) { return map.side / static_cast<double>(map.errors.size()); }

/// Squares from the map's corner to where an error's square has its middle.
double squares_to(const SquareMap& map, double error) {
  const double step = (map.errors.back() - map.errors.front()) / static_cast<double>(map.errors.size() - 1);
  return (error - map.errors.front()) / step + 0.5;
}
double x_of(const SquareMap& map, double error) { return map.left + cell_of(map) * squares_to(map, error); }
double y_of(const SquareMap& map, double error) { return map.top + map.side - cell_of(map) * squares_to(map, error); }

}  // namespace

double square_x(const SquareMap& map, std::size_t medial) { return x_of(map, map.errors.at(medial)); }
double square_y(const SquareMap& map, std::size_t cranial) { return y_of(map, map.errors.at(cranial)); }

std::string square_map_svg(const SquareMap& map) {
  constexpr double kNamedApart = 2.0;
  const double cell = cell_of(map);
  std::string svg = "<g shape-rendering=\"crispEdges\">\n";  // so that no gaps show
  for (std::size_t cranial = 0; cranial < map.errors.size(); ++cranial) {
    for (std::size_t medial = 0; medial < map.errors.size(); ++medial) {
      const std::string fill = map.fill(medial, cranial);
      if (fill.empty()) continue;
      svg += svg_box(square_x(map, medial) - 0.5 * cell, square_y(map, cranial) - 0.5 * cell, cell, cell, fill);
    }
  }
  svg += "</g>\n";
  const double low = map.errors.front(), high = map.errors.back();
  for (double error = kNamedApart * std::ceil(low / kNamedApart); error <= high; error += kNamedApart) {
    svg += svg_text(x_of(map, error), map.top + map.side + 14.0, "middle", svg_number(error));
    svg += svg_text(map.left - 6.0, y_of(map, error) + 4.5, "end", svg_number(error));
  }
  if (map.frames_none) {
    svg += svg_box(x_of(map, 0.0) - 0.5 * cell, y_of(map, 0.0) - 0.5 * cell, cell, cell,
                   "stroke=\"#000\" stroke-width=\"1.6\" fill=\"none\"");
  } else {
    svg += "<path d=\"M" + svg_number(x_of(map, 0.0) - 5.0) + " " + svg_number(y_of(map, 0.0)) +
           "h10m-5 -5v10\" stroke=\"#000\" stroke-width=\"1.6\" fill=\"none\"/>\n";
  }
  svg += svg_text(map.left + 0.5 * map.side, map.top + map.side + 30.0, "middle", map.unit + " medial");
  svg += svg_text(0.0, 0.0, "middle", map.unit + " cranial",
                  "font-size=\"12\" transform=\"translate(" + svg_number(map.left - 34.0) + " " +
                      svg_number(map.top + 0.5 * map.side) + ") rotate(-90)\"");
  return svg;
}

}  // namespace spinaltap
