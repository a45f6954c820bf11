#pragma once

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

}  // namespace spinaltap
