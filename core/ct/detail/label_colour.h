#pragma once

#include "core/base/geometry.h"

namespace spinaltap::detail {

/// Red, green and blue of a label, from 0 to 1. Neighbours do not share them: hues are a golden section of the circle
/// apart (a row of them is spread evenly, however long it is), pale enough for the outlines of slices.
Vec3 label_colour(int number);

}  // namespace spinaltap::detail
