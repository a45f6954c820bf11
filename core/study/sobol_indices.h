#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/statistics.h"

namespace spinaltap {

struct SobolOptions {
  int resamples = 1000;  ///< of the intervals' bootstrap: 100 to 100,000
  std::uint64_t seed = 1;
};

/// Shares of the output's variance, with 95 % intervals. Estimates and intervals may lie a little below 0 or above 1.
struct SobolIndex {
  double first_order = 0.0;  ///< that the group's inputs explain alone
  double total = 0.0;        ///< that would be left if all but them were known: with what they do together with others
  Interval first_order_interval;
  Interval total_interval;
};

struct SobolIndices {
  std::size_t blocks = 0;
  double mean = 0.0;      ///< of A and B
  double variance = 0.0;  ///< of A and B
  std::vector<SobolIndex> groups;
};

/// Sobol's indices of groups of inputs, from the outputs of blocks of groups + 2 runs: one with all inputs of a draw A,
/// one with all of a draw B, and one a group with its inputs of B and the rest of A, in this order. The design is that
/// of Saltelli et al., "Variance based sensitivity analysis of model output", Comput. Phys. Commun. 2010; total by
/// Jansen, "Analysis of variance designs for model output", the same journal 1999. First order: the covariance of B
/// with the group's runs over the mean of their variances (Janon, Klein, Lagnoux, Nodet & Prieur, "Asymptotic normality
/// and efficiency of two Sobol index estimators", ESAIM Probab. Stat. 2014), less what A and B, which share nothing,
/// agree in by chance. Saltelli's own formula takes that off whole; here it has the weight 1 - total, the share of A
/// that is still in the group's runs, which makes the largest index 3 times as sure. Intervals are percentiles of a
/// bootstrap over blocks, expanded for their number; docs/study-statistics.md has how often they hold the truth. Where
/// the output does not vary, indices and intervals are not numbers; where it varies in so few blocks that resamples may
/// hold none of them, intervals are 0 to 1. Bit for bit the same at any thread count. Throws Error on outputs that are
/// not finite or not whole blocks, on no groups, on fewer than kMinSobolBlocks blocks, and on options out of range.
SobolIndices sobol_indices(std::span<const double> outputs, std::size_t groups, const SobolOptions& options = {},
                           const Progress& progress = {});

inline constexpr std::size_t kMinSobolBlocks = 16;

}  // namespace spinaltap
