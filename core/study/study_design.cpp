#include "core/study/study_design.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/base/statistics.h"
#include "core/force/force_band.h"

namespace spinaltap {
namespace {

constexpr std::array<std::string_view, kStudyFactors> kFactorNames{
    "entry_left_mm",     "entry_head_mm", "angle_left_deg",    "angle_head_deg",
    "bit_diameter_mm",   "push_n",        "feed_mm_s",         "tremor_mm",
    "density_scale",     "force_scale",   "entry_error_scale", "direction_error_scale",
    "registration_scale"};
constexpr std::array<std::string_view, kStudyDraws> kDrawNames{"entry", "direction", "along", "registration", "screw"};

// Streams of random numbers of one study: no two share a seed of the counter.
enum class Stream : std::uint64_t {
  tremor = 0,
  draws = 16,
  strata = 32,
  registration = 48,
  placement = 64,
  screw = 80
};

std::uint64_t offset_of(Stream stream, std::uint64_t part = 0) { return static_cast<std::uint64_t>(stream) + part; }

std::uint64_t seed_of_stream(std::uint64_t seed, std::uint64_t offset) { return mix_bits(mix_bits(seed) + offset); }

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

constexpr std::uint64_t kRoom = 8;  ///< of numbers that a run has of a stream, for six

double normal_of(double share) { return normal_quantile(std::clamp(share, 0x1.0p-54, 1.0 - 0x1.0p-53)); }

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

std::string_view name_of(StudyDraw draw) { return kDrawNames.at(static_cast<std::size_t>(draw)); }

std::string_view name_of(DrawnPer per) {
  constexpr std::array<std::string_view, 3> kNames{"run", "screw", "patient"};
  return kNames.at(static_cast<std::size_t>(per));
}

std::string_view name_of(StudySampling sampling) {
  constexpr std::array<std::string_view, 3> kNames{"random", "latin-hypercube", "saltelli"};
  return kNames.at(static_cast<std::size_t>(sampling));
}

StudyRuns::StudyRuns(StudyDesign design, StudyGround ground)
    : design_(std::move(design)), ground_(std::move(ground)), count_(design_.runs) {
  if (ground_.patients.empty()) fail("study: expected a screw or more, found none");
  const bool is_saltelli = design_.sampling == StudySampling::saltelli;
  // By division, so that a product beyond all numbers is seen.
  const auto times = [this](std::size_t more) { count_ = count_ > kMaxRuns / more ? kMaxRuns + 1 : count_ * more; };
  std::array<bool, kStudyFactors> met{};
  for (const FactorDistribution& distribution : design_.distributions) {
    const std::string_view name = name_of(distribution.factor);
    if (std::exchange(met.at(static_cast<std::size_t>(distribution.factor)), true)) {
      fail("study: expected each factor once, found ", name, " twice");
    }
    check(distribution);
    const bool has_levels = distribution.kind == FactorDistribution::Kind::levels;
    if (distribution.per != DrawnPer::run && (has_levels || design_.sampling != StudySampling::random)) {
      fail(name, ": expected \"per\": \"", name_of(distribution.per), "\" only of what is drawn, in random sampling");
    }
    if (is_saltelli && has_levels && distribution.levels.size() > 1) {
      fail(name, ": expected a distribution in Saltelli's design, found levels");
    }
    if (is_saltelli && !has_levels) inputs_.emplace_back(name);
    if (has_levels) times(distribution.levels.size());
  }
  runs_a_screw_ = count_;
  draws_.fill(std::numeric_limits<std::size_t>::max());
  if (is_saltelli) {
    const auto add = [this](StudyDraw draw) {
      draws_[static_cast<std::size_t>(draw)] = inputs_.size();
      inputs_.emplace_back(name_of(draw));
    };
    if (ground_.has_errors) {
      for (const StudyDraw draw : {StudyDraw::entry, StudyDraw::direction, StudyDraw::along}) add(draw);
    }
    if (ground_.has_registration) add(StudyDraw::registration);
    if (ground_.patients.size() > 1) add(StudyDraw::screw);
    if (inputs_.empty()) fail("study: expected something that is drawn in Saltelli's design, found nothing");
    times(inputs_.size() + 2);
  } else {
    times(ground_.patients.size());
  }
  if (count_ == 0 || count_ > kMaxRuns) {
    fail("study: expected 1 to ", kMaxRuns, " runs, found ", count_ == 0 ? "none" : "more");
  }
  strata_.resize(design_.distributions.size());
  for (std::size_t n = 0; n < design_.distributions.size(); ++n) {
    if (design_.sampling != StudySampling::latin_hypercube ||
        design_.distributions[n].kind == FactorDistribution::Kind::levels) {
      continue;
    }
    const auto factor = static_cast<std::uint64_t>(design_.distributions[n].factor);
    strata_[n] = shuffled(count_, seed_of_stream(design_.seed, offset_of(Stream::strata, factor)));
  }
}

std::size_t StudyRuns::screw_of(std::size_t n) const {
  if (design_.sampling != StudySampling::saltelli) return n / runs_a_screw_;
  const std::size_t input = input_of(StudyDraw::screw);
  if (input >= inputs_.size()) return 0;
  const std::size_t screws = ground_.patients.size();
  const double share = number(offset_of(Stream::screw), input, n, DrawnPer::run, 0, 1);
  return std::min(screws - 1, static_cast<std::size_t>(share * static_cast<double>(screws)));
}

/// Which numbers of a stream run n has.
std::size_t StudyRuns::place_of(std::size_t n, DrawnPer per) const {
  switch (per) {
    case DrawnPer::screw:
      return screw_of(n);
    case DrawnPer::patient:
      return patient_of(n);
    case DrawnPer::run:
      break;
  }
  return n;
}

/// Number `k` of `room` that run n has of a stream, from 0 to below 1.
double StudyRuns::number(std::uint64_t stream, std::size_t input, std::size_t n, DrawnPer per, std::uint64_t k,
                         std::uint64_t room) const {
  const std::uint64_t seed = seed_of_stream(design_.seed, stream);
  if (design_.sampling != StudySampling::saltelli) return random_uniform(seed, room * place_of(n, per) + k);
  const std::size_t in_block = n % (inputs_.size() + 2);
  const bool is_from_b = in_block == 1 || in_block == input + 2;
  return random_uniform(mix_bits(seed + (is_from_b ? 1 : 0)), room * (n / (inputs_.size() + 2)) + k);
}

double StudyRuns::probability(std::size_t distribution, std::size_t n) const {
  const FactorDistribution& of = design_.distributions[distribution];
  std::size_t input = 0;
  for (std::size_t d = 0; d < distribution; ++d) {
    if (design_.distributions[d].kind != FactorDistribution::Kind::levels) ++input;
  }
  double share = number(offset_of(Stream::draws, static_cast<std::uint64_t>(of.factor)), input, n, of.per, 0, 1);
  if (!strata_[distribution].empty()) share = (share + strata_[distribution][n]) / static_cast<double>(count_);
  // The ends themselves have no quantile.
  return std::clamp(share, 0x1.0p-54, 1.0 - 0x1.0p-53);
}

FactorValues StudyRuns::values(std::size_t n, const FactorValues& base) const {
  FactorValues values = base;
  std::size_t combination = n % runs_a_screw_;
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

std::array<double, 6> StudyRuns::placement_normals(std::size_t n) const {
  // Which input each of the numbers is of: see error_of().
  constexpr std::array<StudyDraw, 6> kDraws{StudyDraw::entry,     StudyDraw::entry, StudyDraw::direction,
                                            StudyDraw::direction, StudyDraw::along, StudyDraw::along};
  std::array<double, 6> normals{};
  for (std::size_t k = 0; k < normals.size(); ++k) {
    normals[k] = normal_of(number(offset_of(Stream::placement), input_of(kDraws[k]), n, DrawnPer::run, k, kRoom));
  }
  return normals;
}

std::array<double, 6> StudyRuns::registration_normals(std::size_t n) const {
  std::array<double, 6> normals{};
  for (std::size_t k = 0; k < normals.size(); ++k) {
    normals[k] = normal_of(number(offset_of(Stream::registration), input_of(StudyDraw::registration), n,
                                  ground_.registration_per, k, kRoom));
  }
  return normals;
}

std::uint64_t StudyRuns::seed_of(std::size_t n) const {
  if (design_.sampling == StudySampling::saltelli) n /= inputs_.size() + 2;
  return mix_bits(seed_of_stream(design_.seed, offset_of(Stream::tremor)) ^ n) >> 32;
}

}  // namespace spinaltap
