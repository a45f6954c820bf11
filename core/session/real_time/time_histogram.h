#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/session/real_time/timing.h"

namespace spinaltap {

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
  std::uint64_t most_ns_ = 0;
};

}  // namespace spinaltap
