#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace spinaltap {

/// CPU time of the calling thread, ns. Unlike wall time, what other programs take does not count; nor does the work of
/// other threads.
std::int64_t thread_cpu_ns();
/// CPU time of all threads of the program, ns.
std::int64_t process_cpu_ns();
/// Steady wall time, ns.
std::int64_t wall_ns();

/// What two readings in a row are apart: the median of many, ns. To be taken off what is measured between two readings.
struct ClockCosts {
  std::int64_t cpu_ns = 0;
  std::int64_t wall_ns = 0;
};
/// Takes some milliseconds.
ClockCosts measure_clock_costs();

/// How the times of many cycles spread, µs. Percentiles are times that were measured: the least that so many of them do
/// not exceed.
struct TimeSpread {
  double p50_us = 0.0;
  double p99_us = 0.0;
  double p999_us = 0.0;
  double max_us = 0.0;
};
/// All 0 without samples.
TimeSpread spread_of(std::vector<std::int64_t> samples_ns);

/// Counts times in bins whose width is 1/128 of what they hold, so that percentiles of any number of cycles take 40 kB
/// and are known to 1 %. `add` allocates nothing.
class TimeHistogram {
 public:
  /// Times below 0 count as 0.
  void add(std::int64_t time_ns) noexcept;

  std::uint64_t count() const { return count_; }
  /// Percentiles are their bins' upper ends, so at most 1 % above times that were measured; the greatest is exact.
  TimeSpread spread() const;
  /// Counts; bin n: 2^n to 2^(n+1) µs, the first from 0. As many bins as it takes.
  std::vector<std::uint64_t> octaves() const;

 private:
  static constexpr int kBits = 7;                                 ///< 2^7 bins an octave
  static constexpr std::size_t kBins = std::size_t{35} << kBits;  ///< up to 2^41 ns, over half an hour

  static std::size_t bin_of(std::uint64_t time_ns);
  static std::uint64_t last_of(std::size_t bin);

  std::array<std::uint64_t, kBins> counts_{};
  std::array<std::uint64_t, 32> octaves_{};
  std::uint64_t count_ = 0;
  std::uint64_t max_ns_ = 0;
};

}  // namespace spinaltap
