#include "core/session/real_time/time_histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace spinaltap {

// Times below 2^(kBits+1) have bins of their own. Above, a time's leading kBits + 1 bits name its bin within its
// octave.
std::size_t TimeHistogram::bin_of(std::uint64_t time_ns) {
  const int shift = std::max(0, static_cast<int>(std::bit_width(time_ns)) - (kBits + 1));
  const std::size_t bin = (static_cast<std::size_t>(shift) << kBits) + static_cast<std::size_t>(time_ns >> shift);
  return std::min(bin, kBins - 1);
}

std::uint64_t TimeHistogram::last_of(std::size_t bin) {
  const std::size_t octave = bin >> kBits;
  const std::size_t shift = octave > 1 ? octave - 1 : 0;
  return ((bin - (shift << kBits) + 1) << shift) - 1;
}

void TimeHistogram::add(std::int64_t time_ns) noexcept {
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(time_ns, 0));
  ++counts_[bin_of(time)];
  const std::uint64_t time_us = time / 1000;
  const std::size_t octave = time_us < 2 ? 0 : static_cast<std::size_t>(std::bit_width(time_us)) - 1;
  ++octaves_[std::min(octave, octaves_.size() - 1)];
  ++count_;
  most_ns_ = std::max(most_ns_, time);
}

TimeSpread TimeHistogram::spread() const {
  if (count_ == 0) return {};
  const auto percentile_us = [&](double share) {
    const auto rank = static_cast<std::uint64_t>(std::max(1.0, std::ceil(share * static_cast<double>(count_))));
    std::uint64_t below = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
      below += counts_[bin];
      if (below >= rank) return 1e-3 * static_cast<double>(std::min(last_of(bin), most_ns_));
    }
    return 1e-3 * static_cast<double>(most_ns_);
  };
  return {percentile_us(0.5), percentile_us(0.99), percentile_us(0.999), 1e-3 * static_cast<double>(most_ns_)};
}

std::vector<std::uint64_t> TimeHistogram::octaves() const {
  std::size_t bins = octaves_.size();
  while (bins > 0 && octaves_[bins - 1] == 0) --bins;
  return {octaves_.begin(), octaves_.begin() + static_cast<std::ptrdiff_t>(bins)};
}

}  // namespace spinaltap
