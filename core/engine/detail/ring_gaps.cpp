#include "core/engine/detail/ring_gaps.h"

#include <cmath>
#include <limits>

namespace spinaltap {
namespace {

constexpr double kFloatMm = 2e-6;  // rounding of float
constexpr double kNoneMm = 1e15;

}  // namespace

RingGaps::RingGaps(std::size_t discs, const DiscPattern& pattern, const detail::DiscKernels& kernels)
    : kernels_(kernels),
      pattern_(pattern),
      unit_mm_(pattern.ring_count() * pattern.spacing_mm() / std::numeric_limits<std::int16_t>::max()),
      units_per_mm_(1.0 / unit_mm_),
      rounding_mm_(unit_mm_ + kFloatMm),
      rings_(static_cast<std::size_t>(pattern.ring_count())),
      ends_(discs * rings_ + detail::kLongestVector, detail::kUnknownGap) {
  for (auto* column : {&below_x_, &below_y_, &above_x_, &above_y_}) column->assign(ends_.size(), 0);
}

std::int16_t RingGaps::units(double mm) const noexcept {
  const double units = mm * units_per_mm_;
  return static_cast<std::int16_t>(units < 0.0 ? units - 0.5 : units + 0.5);
}

RingGaps::Ends RingGaps::faced_gap(int disc, int ring, double x_mm, double y_mm) const noexcept {
  const detail::GapEnds ends = ends_[place(disc, ring)];
  const std::size_t size = DiscPattern::ring_size(ring);
  const Ends gap{ends & 0xffff, ends >> 16};
  if (gap.below >= size) return {};
  const std::size_t start = DiscPattern::ring_start(ring);
  const Eigen::Vector2d& below_mm = pattern_.point_mm(start + gap.below);
  const Eigen::Vector2d& above_mm = pattern_.point_mm(start + gap.above);
  const double from_below = below_mm[0] * y_mm - below_mm[1] * x_mm;
  const double to_above = x_mm * above_mm[1] - y_mm * above_mm[0];
  // Gaps of half a turn and more hold all that does not lie in the rest.
  const std::size_t turned = gap.above > gap.below ? gap.above - gap.below : gap.above + size - gap.below;
  const bool is_faced = 2 * turned < size ? from_below > 0.0 && to_above > 0.0 : !(from_below < 0.0 && to_above < 0.0);
  return is_faced ? gap : Ends{};
}

void RingGaps::set_gap(int disc, int ring, std::size_t below, std::size_t above) noexcept {
  const std::size_t n = place(disc, ring);
  const std::size_t start = DiscPattern::ring_start(ring);
  const Eigen::Vector2d& below_mm = pattern_.point_mm(start + below);
  const Eigen::Vector2d& above_mm = pattern_.point_mm(start + above);
  ends_[n] = static_cast<detail::GapEnds>(below | above << 16);
  below_x_[n] = units(below_mm[0]);
  below_y_[n] = units(below_mm[1]);
  above_x_[n] = units(above_mm[0]);
  above_y_[n] = units(above_mm[1]);
}

double RingGaps::min_distance_mm(int disc, int begin, int end, double x_mm, double y_mm, double reach_mm,
                                 const detail::FloatEllipse& ellipse, std::uint8_t* reached) const noexcept {
  const auto in_units = [&](double mm) { return static_cast<float>(mm * units_per_mm_); };
  const float x = in_units(x_mm), y = in_units(y_mm), reach = in_units(reach_mm + rounding_mm_);
  const std::size_t first = place(disc, 0);
  detail::GapResult result{reached, 0.0F};
  kernels_.gap_squares(
      {ends_.data() + first, below_x_.data() + first, below_y_.data() + first, above_x_.data() + first,
       above_y_.data() + first, ellipse, x, y, std::sqrt(x * x + y * y), in_units(pattern_.spacing_mm()),
       reach < 0.0F ? -1.0F : reach * reach, static_cast<std::size_t>(begin), static_cast<std::size_t>(end)},
      result);
  if (result.least_square == detail::kNoSquare) return kNoneMm;
  return static_cast<double>(std::sqrt(result.least_square)) * unit_mm_ - rounding_mm_;
}

std::size_t RingGaps::memory_bytes() const { return ends_.size() * (sizeof(ends_[0]) + 4 * sizeof(below_x_[0])); }

}  // namespace spinaltap
