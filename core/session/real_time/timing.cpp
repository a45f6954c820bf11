#include "core/session/real_time/timing.h"

#include <algorithm>
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

}  // namespace spinaltap
