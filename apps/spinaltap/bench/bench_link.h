#pragma once

#include "core/base/progress.h"
#include "core/files/json_file.h"

namespace spinaltap {

struct LinkBenchOptions {
  double seconds = 60.0;
  double rate_hz = 1000.0;
  int stops = 100;             ///< sessions that are drilled until a rule stops them
  double nonsense_mb_s = 0.0;  ///< of a peer that sends nonsense beside the round trips
};

/// Measures `spinaltap link` over the loopback, client and all in this program: round trips of poses beside the live
/// mesh, and stops from the pose that crosses a threshold to the socket. Prints, and gives the figures.
Json bench_link(const LinkBenchOptions& options, const Progress& progress);

}  // namespace spinaltap
