#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/rbf/radial_kernel.h"

namespace spinaltap::detail {

/// The centres that choosing begins with: those that determine the polynomial, then points spread evenly, a hundredth
/// of all and 64 at least (all when there are fewer). Throws Error when the points do not determine the polynomial.
std::vector<std::uint32_t> first_centres(RadialKernel kernel, std::span<const Vec3> points_mm);

}  // namespace spinaltap::detail
