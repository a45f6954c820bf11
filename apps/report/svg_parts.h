#pragma once

#include <string>
#include <string_view>

namespace spinaltap {

/// Elements of a drawing. `style`, `fill`: further attributes, as they are; of a text only its words are escaped.
std::string svg_text(double x, double y, std::string_view anchor, std::string_view words, std::string_view style = "");
std::string svg_box(double x, double y, double width, double height, std::string_view fill);

/// The attribute of one colour.
std::string svg_fill(std::string_view colour);

}  // namespace spinaltap
