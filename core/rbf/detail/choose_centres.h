#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/rbf/rbf_model.h"

namespace spinaltap::detail {

/// The centres that choosing begins with: those that determine the polynomial, then points spread evenly, a hundredth
/// of all and 64 at least (all when there are fewer). Throws Error when the points do not determine the polynomial.
std::vector<std::uint32_t> first_centres(RadialKernel kernel, std::span<const Vec3> points_mm);

/// Of the points in `out` (worst first) those that become centres in one round: no two near to each other, for the fit
/// changes around each, and at most half as many as there are `centres`.
std::vector<std::uint32_t> spread_worst(std::span<const Vec3> points_mm, const std::vector<std::uint32_t>& out,
                                        std::size_t centres);

/// The chosen ones of all.
template <class T>
std::vector<T> pick(std::span<const T> all, const std::vector<std::uint32_t>& chosen) {
  std::vector<T> picked;
  picked.reserve(chosen.size());
  for (const std::uint32_t i : chosen) picked.push_back(all[i]);
  return picked;
}

}  // namespace spinaltap::detail
