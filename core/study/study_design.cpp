#include "core/study/study_design.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/base/statistics.h"

namespace spinaltap {
namespace {

constexpr std::array<std::string_view, kStudyFactors> kNames{"entry_left_mm",  "entry_head_mm",   "angle_left_deg",
                                                             "angle_head_deg", "bit_diameter_mm", "push_n",
                                                             "feed_mm_s",      "tremor_mm",       "density_scale"};

// Streams of random numbers of one study: no two share a seed of the counter.
enum class Stream : std::uint64_t { tremor = 0, draws = 16, strata = 32 };

std::uint64_t seed_of_stream(std::uint64_t seed, Stream stream, StudyFactor factor = {}) {
  return mix_bits(mix_bits(seed) + static_cast<std::uint64_t>(stream) + static_cast<std::uint64_t>(factor));
}

void check(const FactorLaw& law) {
  const std::string_view name = name_of(law.factor);
  switch (law.kind) {
    case FactorLaw::Kind::levels:
      if (law.levels.empty()) fail(name, ": expected one level or more, found none");
      for (const double level : law.levels) {
        if (!std::isfinite(level)) fail(name, ": expected finite levels, found ", level);
      }
      return;
    case FactorLaw::Kind::normal:
      if (!std::isfinite(law.a) || !(law.b >= 0.0) || !std::isfinite(law.b)) {
        fail(name, ": expected a finite mean and a deviation of 0 or more, found ", law.a, " and ", law.b);
      }
      return;
    case FactorLaw::Kind::uniform:
      if (!std::isfinite(law.a) || !(law.b >= law.a) || !std::isfinite(law.b)) {
        fail(name, ": expected a low end and a high one not below it, found ", law.a, " and ", law.b);
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

std::string_view name_of(StudyFactor factor) { return kNames.at(static_cast<std::size_t>(factor)); }

StudyRuns::StudyRuns(StudyDesign design) : design_(std::move(design)), count_(design_.runs) {
  std::array<bool, kStudyFactors> met{};
  for (const FactorLaw& law : design_.laws) {
    if (std::exchange(met.at(static_cast<std::size_t>(law.factor)), true)) {
      fail("study: expected each factor once, found ", name_of(law.factor), " twice");
    }
    check(law);
    // By division, so that a product beyond all numbers is seen.
    const std::size_t levels = law.kind == FactorLaw::Kind::levels ? law.levels.size() : 1;
    count_ = count_ > kMostRuns / levels ? kMostRuns + 1 : count_ * levels;
  }
  if (count_ == 0 || count_ > kMostRuns) {
    fail("study: expected 1 to ", kMostRuns, " runs, found ", count_ == 0 ? "none" : "more");
  }
  strata_.resize(design_.laws.size());
  for (std::size_t n = 0; n < design_.laws.size(); ++n) {
    if (!design_.is_latin || design_.laws[n].kind == FactorLaw::Kind::levels) continue;
    strata_[n] = shuffled(count_, seed_of_stream(design_.seed, Stream::strata, design_.laws[n].factor));
  }
}

double StudyRuns::probability(std::size_t law, std::size_t n) const {
  double share = random_uniform(seed_of_stream(design_.seed, Stream::draws, design_.laws[law].factor), n);
  if (design_.is_latin) share = (share + strata_[law][n]) / static_cast<double>(count_);
  // The ends themselves have no quantile.
  return std::clamp(share, 0x1.0p-54, 1.0 - 0x1.0p-53);
}

FactorValues StudyRuns::values(std::size_t n, const FactorValues& base) const {
  FactorValues values = base;
  std::size_t combination = n;
  for (std::size_t law_index = 0; law_index < design_.laws.size(); ++law_index) {
    const FactorLaw& law = design_.laws[law_index];
    double& value = values.at(static_cast<std::size_t>(law.factor));
    switch (law.kind) {
      case FactorLaw::Kind::levels:
        value = law.levels[combination % law.levels.size()];
        combination /= law.levels.size();
        break;
      case FactorLaw::Kind::normal:
        value = law.a + law.b * normal_quantile(probability(law_index, n));
        break;
      case FactorLaw::Kind::uniform:
        value = law.a + (law.b - law.a) * probability(law_index, n);
        break;
    }
  }
  return values;
}

std::uint64_t StudyRuns::seed_of(std::size_t n) const {
  return mix_bits(seed_of_stream(design_.seed, Stream::tremor) ^ n) >> 32;
}

}  // namespace spinaltap
