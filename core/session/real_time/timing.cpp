#include "core/session/real_time/timing.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <ctime>

namespace spinaltap {
namespace {

std::int64_t read_ns(clockid_t clock) {
  std::timespec time{};
  ::clock_gettime(clock, &time);
  return std::int64_t{1'000'000'000} * time.tv_sec + time.tv_nsec;
}

template <class Clock>
std::int64_t cost_ns(const Clock& clock) {
  std::vector<std::int64_t> costs(10'001);
  for (std::int64_t& cost : costs) {
    const std::int64_t start = clock();
    cost = clock() - start;
  }
  const auto middle = costs.begin() + static_cast<std::ptrdiff_t>(costs.size() / 2);
  std::nth_element(costs.begin(), middle, costs.end());
  return *middle;
}

}  // namespace

std::int64_t thread_cpu_ns() { return read_ns(CLOCK_THREAD_CPUTIME_ID); }

std::int64_t process_cpu_ns() { return read_ns(CLOCK_PROCESS_CPUTIME_ID); }

std::int64_t wall_ns() {
  const auto since = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(since).count();
}

ClockCosts measure_clock_costs() { return {cost_ns(thread_cpu_ns), cost_ns(wall_ns)}; }

TimeSpread spread_of(std::vector<std::int64_t> samples_ns) {
  if (samples_ns.empty()) return {};
  std::sort(samples_ns.begin(), samples_ns.end());
  const auto percentile_us = [&](double share) {
    const double rank = std::ceil(share * static_cast<double>(samples_ns.size()));
    return 1e-3 * static_cast<double>(samples_ns[static_cast<std::size_t>(std::max(rank, 1.0)) - 1]);
  };
  return {percentile_us(0.5), percentile_us(0.99), percentile_us(0.999), percentile_us(1.0)};
}

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
  max_ns_ = std::max(max_ns_, time);
}

TimeSpread TimeHistogram::spread() const {
  if (count_ == 0) return {};
  const auto percentile_us = [&](double share) {
    const auto rank = static_cast<std::uint64_t>(std::max(1.0, std::ceil(share * static_cast<double>(count_))));
    std::uint64_t below = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
      below += counts_[bin];
      if (below >= rank) return 1e-3 * static_cast<double>(std::min(last_of(bin), max_ns_));
    }
    return 1e-3 * static_cast<double>(max_ns_);
  };
  return {percentile_us(0.5), percentile_us(0.99), percentile_us(0.999), 1e-3 * static_cast<double>(max_ns_)};
}

std::vector<std::uint64_t> TimeHistogram::octaves() const {
  std::size_t bins = octaves_.size();
  while (bins > 0 && octaves_[bins - 1] == 0) --bins;
  return {octaves_.begin(), octaves_.begin() + static_cast<std::ptrdiff_t>(bins)};
}

}  // namespace spinaltap
