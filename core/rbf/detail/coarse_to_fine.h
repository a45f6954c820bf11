#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap::detail {

/// Points in an order from coarse to fine, each with the nearest of those before it.
struct CoarseToFine {
  std::vector<std::uint32_t> order;  ///< order[k]: the point that comes k-th
  std::size_t neighbours = 0;        ///< most neighbours of a point
  /// Of the k-th point, min(k, neighbours) places in `order`, all below k, at near[k * neighbours].
  std::vector<std::uint32_t> near;

  std::size_t count(std::size_t k) const { return k < neighbours ? k : neighbours; }
};

/// Orders points so that every beginning of the order is spread evenly, nearly the maximin order (each point the one
/// farthest from those before it): level by level points that keep a distance from all before them, which then shrinks.
/// `first` points come first, as they stand; the last fiftieth, points near to others, come last as they stand.
/// Source: Schaefer, Katzfuss & Owhadi 2021, whose order is exact; steps of 15 % serve as well and are found faster.
CoarseToFine coarse_to_fine(std::span<const Vec3> points_mm, std::span<const std::uint32_t> first,
                            std::size_t neighbours);

}  // namespace spinaltap::detail
