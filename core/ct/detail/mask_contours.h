#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace spinaltap::detail {

/// A point of a slice, pixels; pixel centres sit on whole numbers.
struct ContourPoint {
  double a = 0.0;
  double b = 0.0;
};

/// The outlines of the pixels with `label` in a slice of `columns` x `rows`, half-way between pixels in and out,
/// corners cut. A hole is a part of the outline around it, joined by a channel of no width ("keyhole": PS3.3,
/// C.8.8.6.3), so that no outline lies in another's inside: readers that add closed outlines up find the same pixels as
/// those that count crossings. Channels run a quarter of a pixel beside centres. Points on a straight line are left
/// out. Pixels that touch at a corner only are apart.
std::vector<std::vector<ContourPoint>> outlines_of(std::span<const std::uint8_t> slice, int columns, int rows,
                                                   std::uint8_t label);

}  // namespace spinaltap::detail
