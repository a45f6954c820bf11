#include "core/study/sobol_indices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/base/random.h"
#include "tests/support/nan.h"
#include "tests/support/release_only.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

using Inputs = std::array<double, 4>;
using Model = std::function<double(const Inputs&)>;

/// Of inputs that are uniform in 0 to 1; input k belongs to group `group_of[k]`.
std::vector<double> outputs_of(const Model& model, std::size_t blocks, const std::array<std::size_t, 4>& group_of,
                               std::size_t groups, std::uint64_t seed) {
  std::vector<double> outputs;
  for (std::size_t block = 0; block < blocks; ++block) {
    Inputs a{}, b{};
    for (std::size_t k = 0; k < a.size(); ++k) {
      a[k] = random_uniform(mix_bits(seed), 8 * block + k);
      b[k] = random_uniform(mix_bits(seed), 8 * block + 4 + k);
    }
    outputs.push_back(model(a));
    outputs.push_back(model(b));
    for (std::size_t group = 0; group < groups; ++group) {
      Inputs c = a;
      for (std::size_t k = 0; k < c.size(); ++k) {
        if (group_of[k] == group) c[k] = b[k];
      }
      outputs.push_back(model(c));
    }
  }
  return outputs;
}

struct KnownModel {
  Model model;
  std::array<std::size_t, 4> group_of;
  std::vector<double> first_order, total;
};

/// Variances of a sum add up; the last input does nothing.
KnownModel additive() {
  constexpr double kSum = 16.0 + 4.0 + 1.0;
  const std::vector<double> shares{16.0 / kSum, 4.0 / kSum, 1.0 / kSum, 0.0};
  return {[](const Inputs& u) { return 4.0 * u[0] - 2.0 * u[1] + u[2]; }, {0, 1, 2, 3}, shares, shares};
}

/// Ishigami & Homma, "An importance quantification technique in uncertainty analysis for computer models", 1990, with
/// a = 7 and b = 0.1: sin x + a sin² y + b z⁴ sin x, of angles between -pi and pi. z acts with x alone.
KnownModel ishigami() {
  constexpr double kA = 7.0, kB = 0.1;
  const double pi4 = std::pow(std::numbers::pi, 4.0);
  const double of_x = 0.5 * std::pow(1.0 + kB * pi4 / 5.0, 2.0), of_y = kA * kA / 8.0;
  const double of_both = kB * kB * pi4 * pi4 * (1.0 / 18.0 - 1.0 / 50.0);
  const double all = of_x + of_y + of_both;
  const auto model = [](const Inputs& u) {
    const auto angle = [&](std::size_t k) { return std::numbers::pi * (2.0 * u[k] - 1.0); };
    const double sine = std::sin(angle(1));
    return std::sin(angle(0)) * (1.0 + kB * std::pow(angle(2), 4.0)) + kA * sine * sine;
  };
  return {model, {0, 1, 2, 9}, {of_x / all, of_y / all, 0.0}, {(of_x + of_both) / all, of_y / all, of_both / all}};
}

/// How often the intervals hold the truth, of each index, in percent.
struct Coverage {
  std::vector<double> first_order, total;
};
Coverage coverage_of(const KnownModel& known, std::size_t blocks, int seeds) {
  const std::size_t groups = known.first_order.size();
  Coverage coverage{std::vector<double>(groups, 0.0), std::vector<double>(groups, 0.0)};
  const auto holds = [](const Interval& interval, double truth) {
    return interval.low <= truth && truth <= interval.high;
  };
  for (int seed = 0; seed < seeds; ++seed) {
    const auto drawn = static_cast<std::uint64_t>(seed);
    const std::vector<double> outputs = outputs_of(known.model, blocks, known.group_of, groups, 1000 + drawn);
    const SobolIndices found = sobol_indices(outputs, groups, {.resamples = 500, .seed = drawn});
    for (std::size_t n = 0; n < groups; ++n) {
      if (holds(found.groups[n].first_order_interval, known.first_order[n])) coverage.first_order[n] += 100.0 / seeds;
      if (holds(found.groups[n].total_interval, known.total[n])) coverage.total[n] += 100.0 / seeds;
    }
  }
  return coverage;
}

void print(const char* name, std::size_t blocks, const Coverage& coverage) {
  std::printf("%s, %zu blocks:", name, blocks);
  for (std::size_t n = 0; n < coverage.total.size(); ++n) {
    std::printf("  %.1f %.1f", coverage.first_order[n], coverage.total[n]);
  }
  std::printf("\n");
}

/// Of one draw: of 20 intervals one does not hold the truth, and the seeds are some of which all do.
void expect_indices(const KnownModel& known, std::uint64_t seed) {
  constexpr std::size_t kBlocks = 4096;
  const std::size_t groups = known.first_order.size();
  const SobolIndices found = sobol_indices(outputs_of(known.model, kBlocks, known.group_of, groups, seed), groups);
  EXPECT_EQ(found.blocks, kBlocks);
  for (std::size_t n = 0; n < groups; ++n) {
    const SobolIndex& one = found.groups[n];
    EXPECT_NEAR(one.first_order, known.first_order[n], 0.04) << n;
    EXPECT_NEAR(one.total, known.total[n], 0.04) << n;
    EXPECT_LE(one.first_order_interval.low, known.first_order[n]) << n;
    EXPECT_GE(one.first_order_interval.high, known.first_order[n]) << n;
    EXPECT_LE(one.total_interval.low, known.total[n]) << n;
    EXPECT_GE(one.total_interval.high, known.total[n]) << n;
    EXPECT_LT(one.first_order_interval.high - one.first_order_interval.low, 0.09) << n;
    EXPECT_LT(one.total_interval.high - one.total_interval.low, 0.11) << n;
  }
}

TEST(SobolIndices, OfASumAreItsSharesOfTheVariance) { expect_indices(additive(), 4); }

TEST(SobolIndices, OfIshigamisFunctionAreThoseOfItsFormula) { expect_indices(ishigami(), 5); }

TEST(SobolIndices, OfGroupsHoldWhatTheirInputsDoTogether) {
  // x and z of Ishigami's function in one group: with each other they are all but y.
  KnownModel known = ishigami();
  const double both = known.total[0];
  known.group_of = {0, 1, 0, 9};
  known.first_order = known.total = {both, known.total[1]};
  expect_indices(known, 3);
}

TEST(SobolIndices, OfAnInputThatDoesNothingAreExactly0) {
  const KnownModel known = additive();
  const SobolIndices found = sobol_indices(outputs_of(known.model, 64, known.group_of, 4, 5), 4);
  EXPECT_EQ(found.groups[3].total, 0.0);
  EXPECT_NEAR(found.groups[3].first_order, 0.0, 1e-12);
  EXPECT_EQ(found.groups[3].total_interval.high, 0.0);
}

TEST(SobolIndices, KnowMeanAndVariance) {
  const auto model = [](const Inputs& u) { return 1e6 + u[0]; };
  const SobolIndices found = sobol_indices(outputs_of(model, 20000, {0, 9, 9, 9}, 1, 6), 1);
  EXPECT_NEAR(found.mean, 1e6 + 0.5, 0.01);
  EXPECT_NEAR(found.variance, 1.0 / 12.0, 0.001);
  EXPECT_NEAR(found.groups[0].first_order, 1.0, 1e-9);
}

TEST(SobolIndices, HoldTheTruthInNinetyFiveOfAHundred) {
  RELEASE_ONLY();
  constexpr int kSeeds = 500;
  for (const auto& [name, known] : {std::pair{"sum", additive()}, std::pair{"Ishigami", ishigami()}}) {
    const Coverage coverage = coverage_of(known, 256, kSeeds);
    print(name, 256, coverage);
    for (std::size_t n = 0; n < known.total.size(); ++n) {
      // 2 % of the method, and what 500 seeds leave open: one deviation is 1 %.
      if (known.total[n] == 0.0) continue;
      EXPECT_NEAR(coverage.first_order[n], 95.0, 3.0) << name << " " << n;
      EXPECT_NEAR(coverage.total[n], 95.0, 3.0) << name << " " << n;
    }
  }
}

WHOLE_RUNS("SobolIndicesOfManySeeds.*");

TEST(SobolIndicesOfManySeeds, HoldTheTruthInNinetyFiveOfAHundred) {
  for (const std::size_t blocks : {64U, 256U, 1024U}) {
    for (const auto& [name, known] : {std::pair{"sum", additive()}, std::pair{"Ishigami", ishigami()}}) {
      const Coverage coverage = coverage_of(known, blocks, 5000);
      print(name, blocks, coverage);
      for (std::size_t n = 0; n < known.total.size(); ++n) {
        if (known.total[n] == 0.0) continue;
        // One deviation of 5,000 seeds is 0.3 %. With 64 blocks it falls short, as docs/study-statistics.md says.
        EXPECT_NEAR(coverage.first_order[n], 95.0, blocks < 100 ? 4.0 : 2.0) << name << " " << n << " " << blocks;
        EXPECT_NEAR(coverage.total[n], 95.0, blocks < 100 ? 4.0 : 2.0) << name << " " << n << " " << blocks;
      }
    }
  }
}

TEST(SobolIndices, AreTheSameAtAnyNumberOfThreads) {
  const KnownModel known = ishigami();
  const std::vector<double> outputs = outputs_of(known.model, 128, known.group_of, 3, 7);
  const auto at = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return sobol_indices(outputs, 3);
  };
  const SobolIndices one = at(1), four = at(4);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_EQ(one.groups[n].first_order, four.groups[n].first_order);
    EXPECT_EQ(one.groups[n].first_order_interval.low, four.groups[n].first_order_interval.low);
    EXPECT_EQ(one.groups[n].total_interval.high, four.groups[n].total_interval.high);
  }
}

TEST(SobolIndices, AreNoNumbersWhereNothingVaries) {
  for (const double value : {0.0, 0.1, -3e7}) {
    const SobolIndices found = sobol_indices(std::vector<double>(4 * 16, value), 2);
    EXPECT_DOUBLE_EQ(found.mean, value);
    EXPECT_EQ(found.variance, 0.0);
    EXPECT_TRUE(std::isnan(found.groups[1].first_order));
    EXPECT_TRUE(std::isnan(found.groups[1].total_interval.high));
  }
}

TEST(SobolIndices, LeaveOpenWhatHardlyVaries) {
  // One run of 1,200 has the property: a third of all resamples hold none.
  std::vector<double> outputs(3 * 400, 0.0);
  outputs[30] = 1.0;
  const SobolIndices found = sobol_indices(outputs, 1);
  EXPECT_EQ(found.groups[0].total_interval.low, 0.0);
  EXPECT_EQ(found.groups[0].total_interval.high, 1.0);
}

TEST(SobolIndices, TakeNumbersOfAnySize) {
  const KnownModel known = ishigami();
  std::vector<double> outputs = outputs_of(known.model, 64, known.group_of, 3, 8);
  const SobolIndices plain = sobol_indices(outputs, 3);
  for (double& output : outputs) output *= 1e300;
  const SobolIndices large = sobol_indices(outputs, 3);
  EXPECT_NEAR(large.groups[0].total, plain.groups[0].total, 1e-9);
}

TEST(SobolIndices, RejectWhatMakesNoSense) {
  std::vector<double> outputs(4 * 16, 1.0);
  EXPECT_THROW(sobol_indices(outputs, 0), Error);
  EXPECT_THROW(sobol_indices({}, 2), Error);
  EXPECT_THROW(sobol_indices(outputs, std::numeric_limits<std::size_t>::max() - 1), Error);
  EXPECT_THROW(sobol_indices(std::vector<double>(4 * 16 + 1, 1.0), 2), Error);
  EXPECT_THROW(sobol_indices(std::vector<double>(4 * 15, 1.0), 2), Error);
  EXPECT_THROW(sobol_indices(outputs, 2, {.resamples = 0}), Error);
  outputs[9] = test::kNan;
  EXPECT_THAT([&] { sobol_indices(outputs, 2); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("found nan of run 9")));
}

}  // namespace
}  // namespace spinaltap
