#pragma once

#include "core/base/image.h"
#include "core/base/progress.h"
#include "mesh/surface_comparison.h"

namespace spinaltap {

/// The compared surfaces as one picture, from behind: a row for each method, a column for each smoothing, the ground
/// truth beside the last row, with their figures. Throws Error when nothing was compared.
Image comparison_picture(const Comparison& comparison, const Progress& progress = {});

}  // namespace spinaltap
