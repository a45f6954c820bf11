#include "core/force/detail/way_average.h"

#include <algorithm>

namespace spinaltap {

WayAverage::WayAverage(double box_mm, int bins)
    : box_mm_(box_mm),
      bin_mm_(box_mm / bins),
      bins_(2 * static_cast<std::size_t>(bins) + 1, Sums::Zero()),
      silent_mm_(all_mm()) {}

void WayAverage::reset() noexcept {
  std::fill(bins_.begin(), bins_.end(), Sums::Zero());
  youngest_ = 0;
  fill_mm_ = 0.0;
  silent_mm_ = all_mm();
  is_empty_ = true;
}

/// Longer than all bins.
double WayAverage::all_mm() const noexcept { return bin_mm_ * static_cast<double>(bins_.size() + 1); }

void WayAverage::add(double way_mm, const Sums& sums) noexcept {
  if ((sums.array() == 0.0).all()) {
    silent_mm_ += way_mm;
    if (silent_mm_ >= all_mm()) {
      if (!is_empty_) reset();
      return;
    }
  } else {
    silent_mm_ = 0.0;
    is_empty_ = false;
  }
  if (!(way_mm > 0.0)) {
    bins_[youngest_] += sums;
    return;
  }
  // Of a way longer than all bins only the last of it is seen.
  const Sums per_mm = sums / way_mm;
  double left_mm = std::min(way_mm, all_mm());
  for (;;) {
    const double room_mm = bin_mm_ - fill_mm_;
    const double part_mm = std::min(left_mm, room_mm);
    bins_[youngest_] += part_mm * per_mm;
    fill_mm_ += part_mm;
    left_mm -= part_mm;
    if (part_mm < room_mm) return;
    youngest_ = youngest_ + 1 < bins_.size() ? youngest_ + 1 : 0;
    bins_[youngest_].setZero();
    fill_mm_ = 0.0;
    if (!(left_mm > 0.0)) return;
  }
}

/// How much of both boxes, one after the other, lies within `back_mm` of the way's end: the integral of a triangle.
double WayAverage::share_behind(double back_mm) const noexcept {
  const double x = std::clamp(back_mm / box_mm_, 0.0, 2.0);
  return x < 1.0 ? 0.5 * x * x : 1.0 - 0.5 * (2.0 - x) * (2.0 - x);
}

WayAverage::Sums WayAverage::per_mm() const noexcept {
  Sums sum = Sums::Zero();
  if (is_empty_) return sum;
  double begin_mm = 0.0;
  double end_mm = fill_mm_;
  double begin_share = 0.0;
  std::size_t n = youngest_;
  for (std::size_t count = 0; count < bins_.size(); ++count) {
    const double end_share = share_behind(end_mm);
    if (end_mm > begin_mm) sum += (end_share - begin_share) / (end_mm - begin_mm) * bins_[n];
    begin_mm = end_mm;
    begin_share = end_share;
    end_mm += bin_mm_;
    n = n > 0 ? n - 1 : bins_.size() - 1;
  }
  return sum;
}

}  // namespace spinaltap
