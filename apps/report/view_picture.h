#pragma once

#include "core/base/image.h"
#include "core/base/view.h"

namespace spinaltap {

/// The arrays of a view for people to look at, side by side: depth (near bright, far dark; nothing white), normals
/// (x, y, z of -1 to 1 as red, green, blue of 0 to 255) and mask (bone light, walls of removed bone red, bit blue).
Image view_picture(const View& view);

}  // namespace spinaltap
