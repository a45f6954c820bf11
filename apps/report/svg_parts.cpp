#include "apps/report/svg_parts.h"

#include "apps/report/text.h"

namespace spinaltap {

std::string svg_text(double x, double y, std::string_view anchor, std::string_view words, std::string_view style) {
  return "<text x=\"" + svg_number(x) + "\" y=\"" + svg_number(y) + "\" text-anchor=\"" + std::string(anchor) + "\" " +
         std::string(style) + ">" + escape_html(words) + "</text>\n";
}

std::string svg_box(double x, double y, double width, double height, std::string_view fill) {
  return "<rect x=\"" + svg_number(x) + "\" y=\"" + svg_number(y) + "\" width=\"" + svg_number(width) + "\" height=\"" +
         svg_number(height) + "\" " + std::string(fill) + "/>\n";
}

std::string svg_fill(std::string_view colour) { return "fill=\"" + std::string(colour) + "\""; }

}  // namespace spinaltap
