#include "core/study/study_design.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/base/statistics.h"
#include "core/force/force_band.h"

namespace spinaltap {
namespace {

constexpr std::array<std::string_view, kStudyFactors> kFactorNames{
    "entry_left_mm", "entry_head_mm", "angle_left_deg", "angle_head_deg", "bit_diameter_mm",
    "push_n",        "feed_mm_s",     "tremor_mm",      "density_scale",  "force_scale"};

// Streams of random numbers of one study: no two share a seed of the counter.
enum class Stream : std::uint64_t { tremor = 0, draws = 16, strata = 32, registration = 48 };

std::uint64_t seed_of_stream(std::uint64_t seed, Stream stream, StudyFactor factor = {}) {
  return mix_bits(mix_bits(seed) + static_cast<std::uint64_t>(stream) + static_cast<std::uint64_t>(factor));
}

/// Factors are mm, degrees, N and mm/s. What spreads less than this, and more than nothing, is a slip, and no axis of a
/// chart can show it.
constexpr double kMinSpread = 1e-12;
constexpr double kMaxSize = 1e12;

/// `spread`: between the ends, or two levels.
bool is_sound(double value, double spread) {
  return std::abs(value) <= kMaxSize && spread <= kMaxSize && (spread == 0.0 || spread >= kMinSpread);
}

void check(const FactorDistribution& distribution) {
  const std::string_view name = name_of(distribution.factor);
  switch (distribution.kind) {
    case FactorDistribution::Kind::levels: {
      if (distribution.levels.empty()) fail(name, ": expected one level or more, found none");
      std::vector<double> sorted = distribution.levels;
      for (const double level : sorted) {
        if (!std::isfinite(level)) fail(name, ": expected finite levels, found ", level);
      }
      std::sort(sorted.begin(), sorted.end());
      for (std::size_t n = 0; n < sorted.size(); ++n) {
        if (is_sound(sorted[n], n > 0 ? sorted[n] - sorted[n - 1] : 0.0)) continue;
        fail(name, ": expected levels within ", kMaxSize, " that differ by ", kMinSpread, " or more, found ",
             sorted[n]);
      }
      return;
    }
    case FactorDistribution::Kind::normal:
      if (!(distribution.b >= 0.0) || !is_sound(distribution.a, distribution.b)) {
        fail(name, ": expected a mean within ", kMaxSize, " and a deviation of 0, or of ", kMinSpread,
             " or more, found ", distribution.a, " and ", distribution.b);
      }
      return;
    case FactorDistribution::Kind::uniform:
      if (!(distribution.b >= distribution.a) || !is_sound(distribution.a, distribution.b - distribution.a)) {
        fail(name, ": expected a low end within ", kMaxSize, " and a high one that is the same, or higher by ",
             kMinSpread, " or more, found ", distribution.a, " and ", distribution.b);
      }
      return;
    case FactorDistribution::Kind::spread:
      if (!(distribution.a > 0.0) || !(distribution.b >= 0.0) || !(distribution.b <= 5.0) ||
          !is_sound(distribution.a, distribution.b) || distribution.degrees < 1 || distribution.degrees > 1000) {
        fail(name, ": expected a median above 0, a scale of 0 to 5 and 1 to 1000 degrees of freedom, found ",
             distribution.a, ", ", distribution.b, " and ", distribution.degrees);
      }
      return;
  }
}

/// 0, 1, ... in random order (Fisher & Yates).
std::vector<std::uint32_t> shuffled(std::size_t count, std::uint64_t seed) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  for (std::size_t n = count; n > 1; --n) {
    const auto other = static_cast<std::size_t>(random_uniform(seed, n) * static_cast<double>(n));
    std::swap(order[n - 1], order[std::min(other, n - 1)]);
  }
  return order;
}

}  // namespace

std::string_view name_of(StudyFactor factor) { return kFactorNames.at(static_cast<std::size_t>(factor)); }

StudyRuns::StudyRuns(StudyDesign design) : design_(std::move(design)), count_(design_.runs) {
  std::array<bool, kStudyFactors> met{};
  for (const FactorDistribution& distribution : design_.distributions) {
    if (std::exchange(met.at(static_cast<std::size_t>(distribution.factor)), true)) {
      fail("study: expected each factor once, found ", name_of(distribution.factor), " twice");
    }
    check(distribution);
    // By division, so that a product beyond all numbers is seen.
    const std::size_t levels = distribution.kind == FactorDistribution::Kind::levels ? distribution.levels.size() : 1;
    count_ = count_ > kMaxRuns / levels ? kMaxRuns + 1 : count_ * levels;
  }
  if (count_ == 0 || count_ > kMaxRuns) {
    fail("study: expected 1 to ", kMaxRuns, " runs, found ", count_ == 0 ? "none" : "more");
  }
  strata_.resize(design_.distributions.size());
  for (std::size_t n = 0; n < design_.distributions.size(); ++n) {
    if (!design_.is_latin || design_.distributions[n].kind == FactorDistribution::Kind::levels) continue;
    strata_[n] = shuffled(count_, seed_of_stream(design_.seed, Stream::strata, design_.distributions[n].factor));
  }
}

double StudyRuns::probability(std::size_t distribution, std::size_t n) const {
  double share =
      random_uniform(seed_of_stream(design_.seed, Stream::draws, design_.distributions[distribution].factor), n);
  if (design_.is_latin) share = (share + strata_[distribution][n]) / static_cast<double>(count_);
  // The ends themselves have no quantile.
  return std::clamp(share, 0x1.0p-54, 1.0 - 0x1.0p-53);
}

FactorValues StudyRuns::values(std::size_t n, const FactorValues& base) const {
  FactorValues values = base;
  std::size_t combination = n;
  for (std::size_t distribution_index = 0; distribution_index < design_.distributions.size(); ++distribution_index) {
    const FactorDistribution& distribution = design_.distributions[distribution_index];
    double& value = values.at(static_cast<std::size_t>(distribution.factor));
    switch (distribution.kind) {
      case FactorDistribution::Kind::levels:
        value = distribution.levels[combination % distribution.levels.size()];
        combination /= distribution.levels.size();
        break;
      case FactorDistribution::Kind::normal:
        value = distribution.a + distribution.b * normal_quantile(probability(distribution_index, n));
        break;
      case FactorDistribution::Kind::uniform:
        value = distribution.a + (distribution.b - distribution.a) * probability(distribution_index, n);
        break;
      case FactorDistribution::Kind::spread: {
        // The tails of few degrees of freedom reach forces that nothing has.
        constexpr double kLeftOut = 0.005;
        const double share = kLeftOut + (1.0 - 2.0 * kLeftOut) * probability(distribution_index, n);
        value = spread_quantile({distribution.a, distribution.b, static_cast<double>(distribution.degrees)}, share);
        break;
      }
    }
  }
  return values;
}

double StudyRuns::registration_normal(std::size_t n, int k) const {
  constexpr std::uint64_t kNumbers = 8;  // room for six
  return random_normal(seed_of_stream(design_.seed, Stream::registration),
                       kNumbers * n + static_cast<std::uint64_t>(k));
}

std::uint64_t StudyRuns::seed_of(std::size_t n) const {
  return mix_bits(seed_of_stream(design_.seed, Stream::tremor) ^ n) >> 32;
}

}  // namespace spinaltap
