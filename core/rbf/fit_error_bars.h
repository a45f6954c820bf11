#pragma once

#include <span>

#include "core/base/progress.h"
#include "core/rbf/reduce_centres.h"

namespace spinaltap::detail {

/// The smoothest function (least norm of its kernel) that stays within `error_bars_mm` of the values: |s(x_i) - f_i| <=
/// e_i (Carr et al. 2003, section 3). Its weights vanish at points strictly inside their bars, the others sit on an end
/// of theirs and pull outwards, so that it is found by guessing which points those are: each round fits the guess,
/// frees points that push, and takes in the worst of those that are out (a primal-dual active set, Hintermueller, Ito &
/// Kunisch 2002). The few points that determine the polynomial are never freed.
ReducedFit fit_error_bars(RadialKernel kernel, std::span<const Vec3> points_mm, std::span<const double> values_mm,
                          std::span<const double> error_bars_mm, double accuracy_mm, const Progress& progress);

}  // namespace spinaltap::detail
