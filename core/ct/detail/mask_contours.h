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

/// The outlines of the pixels with `label` in a slice of `columns` x `rows`, outer ones and those of holes, half-way
/// between pixels in and out, corners cut: the pixels whose centres lie within an odd number of them are the label's.
/// Points on a straight line are left out. Pixels that touch at a corner only are apart.
std::vector<std::vector<ContourPoint>> outlines_of(std::span<const std::uint8_t> slice, int columns, int rows,
                                                   std::uint8_t label);

}  // namespace spinaltap::detail
