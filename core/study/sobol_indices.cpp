#include "core/study/sobol_indices.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

/// What a block adds to the sums of which all indices are made: of the outputs a and b of A and B, and of c of each
/// group.
struct BlockSums {
  enum : std::size_t { kA, kB, kAA, kBB, kAB, kCount };
};
struct GroupSums {
  enum : std::size_t { kC, kCC, kBC, kStep, kCount };
};

/// Outputs less their mean, over the largest of them without its sign: no square can overflow. Empty where they do not
/// vary.
struct ScaledOutputs {
  double mean = 0.0, scale = 0.0;
  std::vector<double> values;
};
ScaledOutputs scaled(std::span<const double> outputs, std::size_t width) {
  ScaledOutputs made;
  const std::size_t count = outputs.size() / width;
  const auto blocks = static_cast<double>(count);
  for (std::size_t n = 0; n < outputs.size(); n += width) {
    made.mean += 0.5 * outputs[n] / blocks + 0.5 * outputs[n + 1] / blocks;
  }
  double largest = 0.0;
  for (const double output : outputs) largest = std::max(largest, std::abs(output));
  for (const double output : outputs) made.scale = std::max(made.scale, std::abs(output - made.mean));
  // What rounding alone makes of the same number many times.
  if (!(made.scale > 1e-13 * largest)) return made;
  made.values.reserve(outputs.size());
  for (const double output : outputs) made.values.push_back((output - made.mean) / made.scale);
  return made;
}

std::size_t sums_in_all(std::size_t groups) { return BlockSums::kCount + groups * GroupSums::kCount; }

std::vector<double> sums_of_blocks(const std::vector<double>& values, std::size_t groups) {
  std::vector<double> sums;
  const std::size_t width = groups + 2;
  sums.reserve(values.size() / width * sums_in_all(groups));
  for (std::size_t n = 0; n < values.size(); n += width) {
    const double a = values[n], b = values[n + 1];
    sums.insert(sums.end(), {a, b, a * a, b * b, a * b});
    for (std::size_t group = 0; group < groups; ++group) {
      const double c = values[n + 2 + group];
      sums.insert(sums.end(), {c, c * c, b * c, 0.5 * (c - a) * (c - a)});
    }
  }
  return sums;
}

struct Estimate {
  double variance = 0.0;  ///< 0: they do not vary
  std::vector<double> first_order, total;
};
Estimate estimate_of(const std::vector<double>& sums, std::size_t blocks, std::size_t groups) {
  // Rounding of numbers up to 1.
  constexpr double kNoVariance = 1e-15;
  const auto count = static_cast<double>(blocks);
  const double a = sums[BlockSums::kA] / count, b = sums[BlockSums::kB] / count;
  const double mean = 0.5 * (a + b);
  Estimate made;
  made.variance = 0.5 * (sums[BlockSums::kAA] + sums[BlockSums::kBB]) / count - mean * mean;
  if (!(made.variance > kNoVariance)) {
    made.variance = 0.0;
    return made;
  }
  const double variance_b = sums[BlockSums::kBB] / count - b * b;
  const double by_chance = sums[BlockSums::kAB] / count - a * b;
  for (std::size_t group = 0; group < groups; ++group) {
    const double* of_group = sums.data() + BlockSums::kCount + group * GroupSums::kCount;
    const double c = of_group[GroupSums::kC] / count;
    const double total = of_group[GroupSums::kStep] / count / made.variance;
    const double variance = 0.5 * (variance_b + of_group[GroupSums::kCC] / count - c * c);
    const double shared = of_group[GroupSums::kBC] / count - b * c - std::clamp(1.0 - total, 0.0, 1.0) * by_chance;
    made.first_order.push_back(variance > kNoVariance ? shared / variance : 0.0);
    made.total.push_back(total);
  }
  return made;
}

double normal_probability(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

/// Of a normal law's tail, that Student's quantile for so many blocks and their own count in place of one less leave
/// beyond: plain percentiles are too narrow where blocks are few (Hesterberg, "What teachers should know about the
/// bootstrap", Am. Stat. 2015, section 4.2).
double expanded_tail(std::size_t blocks) {
  constexpr double kTail = 0.025;
  constexpr std::size_t kManyBlocks = 1000;
  if (blocks > kManyBlocks) return kTail;
  const double quantile = -student_quantile(kTail, static_cast<int>(blocks) - 1);
  const double factor = std::sqrt(static_cast<double>(blocks) / static_cast<double>(blocks - 1));
  return normal_probability(-factor * quantile);
}

Interval interval_of(std::vector<double>& resampled, double tail) {
  std::sort(resampled.begin(), resampled.end());
  return {quantile(resampled, tail), quantile(resampled, 1.0 - tail)};
}

void check_sobol(std::span<const double> outputs, std::size_t groups, const SobolOptions& options) {
  constexpr int kFewest = 100, kMost = 100000;
  if (groups == 0) fail("Sobol indices: expected a group of inputs or more, found none");
  if (groups >= outputs.size() || outputs.size() % (groups + 2) != 0) {
    fail("Sobol indices: expected outputs in whole blocks of ", groups + 2, ", found ", outputs.size());
  }
  if (outputs.size() / (groups + 2) < kMinSobolBlocks) {
    fail("Sobol indices: expected ", kMinSobolBlocks, " blocks or more, found ", outputs.size() / (groups + 2));
  }
  for (std::size_t n = 0; n < outputs.size(); ++n) {
    if (!std::isfinite(outputs[n])) {
      fail("Sobol indices: expected finite outputs, found ", outputs[n], " of run ", n);
    }
  }
  if (options.resamples < kFewest || options.resamples > kMost) {
    fail("Sobol indices: expected ", kFewest, " to ", kMost, " resamples, found ", options.resamples);
  }
}

}  // namespace

SobolIndices sobol_indices(std::span<const double> outputs, std::size_t groups, const SobolOptions& options,
                           const Progress& progress) {
  check_sobol(outputs, groups, options);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  SobolIndices indices;
  indices.blocks = outputs.size() / (groups + 2);
  const ScaledOutputs all = scaled(outputs, groups + 2);
  indices.mean = all.mean;
  indices.groups.assign(groups, {kNone, kNone, {kNone, kNone}, {kNone, kNone}});
  if (all.values.empty()) return indices;
  const std::vector<double> sums = sums_of_blocks(all.values, groups);
  const std::size_t width = sums_in_all(groups);
  const auto add_block = [&](std::vector<double>& to, std::size_t block) {
    for (std::size_t n = 0; n < width; ++n) to[n] += sums[block * width + n];
  };
  std::vector<double> whole(width, 0.0);
  for (std::size_t block = 0; block < indices.blocks; ++block) add_block(whole, block);
  const Estimate estimate = estimate_of(whole, indices.blocks, groups);
  if (!(estimate.variance > 0.0)) return indices;
  indices.variance = estimate.variance * all.scale * all.scale;

  const auto resamples = static_cast<std::size_t>(options.resamples);
  std::vector<Estimate> resampled(resamples);
  ProgressCounter counter(progress, "intervals of Sobol indices", resamples);
  tbb::parallel_for(std::size_t{0}, resamples, [&](std::size_t n) {
    std::vector<double> drawn(width, 0.0);
    for (std::size_t k = 0; k < indices.blocks; ++k) {
      const double u = random_uniform(options.seed, n * indices.blocks + k);
      const auto block = static_cast<std::size_t>(u * static_cast<double>(indices.blocks));
      add_block(drawn, std::min(block, indices.blocks - 1));  // a product may be rounded up
    }
    resampled[n] = estimate_of(drawn, indices.blocks, groups);
    counter.add();
  });
  const bool may_not_vary =
      std::any_of(resampled.begin(), resampled.end(), [](const Estimate& one) { return !(one.variance > 0.0); });
  const double tail = expanded_tail(indices.blocks);
  for (std::size_t group = 0; group < groups; ++group) {
    SobolIndex& index = indices.groups[group];
    index.first_order = estimate.first_order[group];
    index.total = estimate.total[group];
    index.first_order_interval = index.total_interval = {0.0, 1.0};
    if (may_not_vary) continue;
    std::vector<double> first_order, total;
    for (const Estimate& one : resampled) {
      first_order.push_back(one.first_order[group]);
      total.push_back(one.total[group]);
    }
    index.first_order_interval = interval_of(first_order, tail);
    index.total_interval = interval_of(total, tail);
  }
  return indices;
}

}  // namespace spinaltap
