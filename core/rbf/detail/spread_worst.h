#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap::detail {

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
