#pragma once

#include <vector>

#include "apps/report/slice_marks.h"
#include "core/base/image.h"

namespace spinaltap {

/// Which pixels carry a label: width * height values, rows from the top.
struct LabelPixels {
  int width = 0;
  int height = 0;
  std::vector<int> labels;

  int at(int column, int row) const {
    return labels[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)];
  }
};

/// Colours the pixels of a label that have an edge on another label's, so that neighbours never hide each other's
/// outlines. The picture's own border is no outline. Dashed: 9 pixels drawn and 7 left out, counted along the outline
/// in pixel edges, whatever its direction.
void draw_label_outline(Image& image, const LabelPixels& pixels, int label, const Colour& colour, bool dashed);

}  // namespace spinaltap
