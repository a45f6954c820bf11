#include "core/engine/detail/ring_gaps.h"

#include <cmath>

namespace spinaltap {

RingGaps::RingGaps(std::size_t discs, const DiscPattern& pattern, const detail::DiscKernels& kernels)
    : kernels_(kernels),
      spacing_mm_(static_cast<float>(pattern.spacing_mm())),
      rings_(static_cast<std::size_t>(pattern.ring_count())),
      ends_(discs * rings_ + detail::kLongestVector, detail::kUnknownGap) {
  x_mm_.reserve(pattern.point_count());
  y_mm_.reserve(pattern.point_count());
  for (std::size_t i = 0; i < pattern.point_count(); ++i) {
    x_mm_.push_back(static_cast<float>(pattern.point_mm(i).x()));
    y_mm_.push_back(static_cast<float>(pattern.point_mm(i).y()));
  }
}

double RingGaps::min_distance_mm(int disc, int begin, int end, double x_mm, double y_mm, double reach_mm,
                                 std::uint8_t* is_reached) const noexcept {
  const auto reach = static_cast<float>(reach_mm);
  detail::GapResult result{is_reached, 0.0F};
  kernels_.gap_squares(
      {ends_.data() + place(disc, 0), x_mm_.data(), y_mm_.data(), static_cast<float>(x_mm), static_cast<float>(y_mm),
       static_cast<float>(std::sqrt(x_mm * x_mm + y_mm * y_mm)), spacing_mm_, reach < 0.0F ? -1.0F : reach * reach,
       static_cast<std::size_t>(begin), static_cast<std::size_t>(end)},
      result);
  return static_cast<double>(std::sqrt(result.least_square));
}

std::size_t RingGaps::memory_bytes() const {
  return ends_.size() * sizeof(ends_[0]) + (x_mm_.size() + y_mm_.size()) * sizeof(float);
}

}  // namespace spinaltap
