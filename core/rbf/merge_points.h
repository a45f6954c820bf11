#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap::detail {

/// For each point the first point that stands for it: itself, or an earlier one that stands for itself and lies nearer
/// than `merge_mm` (0: only at the same place).
std::vector<std::uint32_t> merge_points(std::span<const Vec3> points_mm, double merge_mm);

}  // namespace spinaltap::detail
