#include "core/segment/level_names.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/base/text_writer.h"
#include "core/segment/row_gaps.h"

namespace spinaltap {
namespace {

/// A kind of people: its lowest lumbar level, its lowest with ribs, and of 800 how many are of it.
struct Numbering {
  Level lowest, last_ribs;
  double people;
};
constexpr std::array<Numbering, 6> kNumberings{{{Level::kL5, Level::kT12, 740.0},
                                                {Level::kL5, Level::kL1, 19.0},
                                                {Level::kL6, Level::kT12, 17.0},
                                                {Level::kL5, Level{18}, 11.0},
                                                {Level{23}, Level::kT12, 10.0},
                                                {Level{23}, Level{18}, 2.0}}};

constexpr int kC3 = 3;

/// How many levels a kind of people has from the sacrum up to C2, the first that has a body, and the one at a place
/// above the sacrum.
int place_count(const Numbering& kind) { return static_cast<int>(kind.lowest) - static_cast<int>(Level::kC2) + 2; }
Level level_at(const Numbering& kind, int place) {
  return place == 0 ? Level::kSacrum : static_cast<Level>(static_cast<int>(kind.lowest) - place + 1);
}

/// How likely the ribs that were found at a level are. The last pair may be short; of 636 levels of random phantoms
/// that it named none was misnamed, so that it is seldom missed.
double ribs_likelihood(Ribs found, Level level, Level last, bool is_lowest) {
  if (found == Ribs::unknown) return 1.0;
  // Its transverse processes are long, and the first ribs rise beside them; hips stand beside the lowest.
  if (level == Level::kC7) return found == Ribs::none ? 0.7 : found == Ribs::one_side ? 0.2 : 0.1;
  if (is_lowest) return found == Ribs::none ? 0.84 : found == Ribs::one_side ? 0.06 : 0.1;
  const bool has_ribs =
      static_cast<int>(level) >= static_cast<int>(Level::kT1) && static_cast<int>(level) <= static_cast<int>(last);
  const bool is_last = level == last;
  if (!has_ribs) return found == Ribs::none ? 0.96 : found == Ribs::one_side ? 0.03 : 0.01;
  if (is_last) return found == Ribs::none ? 0.02 : found == Ribs::one_side ? 0.14 : 0.84;
  return found == Ribs::none ? 0.03 : found == Ribs::one_side ? 0.12 : 0.85;
}

/// Width of the upper endplate and height behind, mm, C3 to L5 (Panjabi 1991, 1992).
struct BodyMeasures {
  double width_mm, height_mm;
};
constexpr std::array<BodyMeasures, 22> kBodyMeasures{
    {{15.8, 11.6}, {17.2, 11.4}, {17.5, 11.4}, {18.5, 10.9}, {21.8, 12.8}, {24.5, 14.1}, {24.9, 15.6}, {24.6, 15.7},
     {24.5, 16.2}, {24.9, 16.2}, {26.2, 17.4}, {27.8, 18.2}, {29.5, 18.7}, {30.6, 19.3}, {31.9, 20.2}, {34.9, 21.3},
     {39.0, 22.7}, {41.2, 23.8}, {42.6, 24.3}, {44.1, 23.8}, {46.6, 24.1}, {47.3, 22.9}}};

const BodyMeasures& measures_of(Level level) {
  const int row = std::clamp(static_cast<int>(level) - kC3, 0, static_cast<int>(kBodyMeasures.size()) - 1);
  return kBodyMeasures[static_cast<std::size_t>(row)];
}

/// Log likelihood of logarithms of sizes over the table's: each off by chance, all by the person's size.
double log_of_sizes(std::vector<double> off) {
  constexpr double kOne = 0.12, kAll = 0.1;
  // Further off is a body that is crushed, or measured wrongly.
  constexpr double kMost = 0.3;
  for (double& one : off) one = std::clamp(one, -kMost, kMost);
  // Neighbours are off together, by what is measured and by the person.
  constexpr double kTemper = 0.6;
  const auto count = static_cast<double>(off.size());
  double sum = 0.0, squares = 0.0;
  for (const double one : off) {
    sum += one;
    squares += one * one;
  }
  const double shared = kAll * kAll / (kOne * kOne + count * kAll * kAll);
  return -0.5 * kTemper * (squares - shared * sum * sum) / (kOne * kOne);
}

/// Bodies from `first` to `last` with their places above the first, over what the row lacks between them.
struct Stretch {
  std::size_t first = 0;
  std::vector<int> places;
};

/// Log likelihood of the ribs of a stretch where they tell nothing: hips, shoulders or arms taken for ribs are so at
/// all levels beside them.
double log_of_no_ribs(const std::vector<Ribs>& ribs, const Stretch& stretch) {
  constexpr double kSame = 0.9, kKinds = 3.0;
  double sum = -std::log(kKinds);
  for (std::size_t m = 1; m < stretch.places.size(); ++m) {
    const bool is_same = ribs[stretch.first + m] == ribs[stretch.first + m - 1];
    sum += std::log(is_same ? kSame : 0.5 * (1.0 - kSame));
  }
  return sum;
}

std::vector<Stretch> stretches_of(const SpineBodies& spine) {
  std::vector<Stretch> all;
  for (std::size_t n = 0; n < spine.bodies.size(); ++n) {
    const std::optional<int> missing = n == 0 ? std::nullopt : bodies_missing_above(spine, n - 1);
    if (missing) {
      all.back().places.push_back(all.back().places.back() + 1 + *missing);
    } else {
      all.push_back({n, {0}});
    }
  }
  return all;
}

/// How likely a stretch is, of a kind of people and at a place above the sacrum.
struct Vote {
  const Numbering* kind;
  int lowest_place;  ///< of the stretch's first body above the sacrum
  double log_likelihood;
};

/// `of_no_ribs`: log_of_no_ribs() of the stretch.
double log_likelihood(const SpineBodies& spine, const std::vector<Ribs>& ribs, const Stretch& stretch,
                      const Numbering& kind, int lowest_place, double of_no_ribs) {
  double sum = std::log(kind.people), of_ribs = 0.0;
  std::vector<double> widths, heights;
  for (std::size_t m = 0; m < stretch.places.size(); ++m) {
    const std::size_t n = stretch.first + m;
    const int place = lowest_place + stretch.places[m];
    const bool taken_for_sacrum = n == 0 && spine.has_sacrum;
    if (taken_for_sacrum) {
      // A lowest lumbar body that has grown into the sacrum, or the sacrum's second body, may be taken for its first.
      sum += std::log(place == 0 ? 0.97 : place == 1 ? 0.02 : 0.01);
      continue;
    }
    if (place < 0) return -1e9;
    const Level level = level_at(kind, place);
    if (level == Level::kSacrum) {
      sum += std::log(0.03);
      continue;
    }
    of_ribs += std::log(ribs_likelihood(ribs[n], level, kind.last_ribs, place == 1));
    if (spine.chain[n].is_cut()) continue;
    if (static_cast<int>(level) < kC3) continue;  // its dens may be taken with it
    const Vec3& half_mm = spine.bodies[n].cylinder.half_mm;
    const BodyMeasures& measures = measures_of(level);
    widths.push_back(std::log(2.0 * half_mm.x() / measures.width_mm));
    heights.push_back(std::log(2.0 * half_mm.z() / measures.height_mm));
  }
  constexpr double kTellNothing = 0.03;
  const double ribs_sum = std::log((1.0 - kTellNothing) * std::exp(of_ribs) + kTellNothing * std::exp(of_no_ribs));
  return sum + ribs_sum + log_of_sizes(widths) + log_of_sizes(heights);
}

/// All places of a stretch in all kinds of people.
std::vector<Vote> votes_of(const SpineBodies& spine, const std::vector<Ribs>& ribs, const Stretch& stretch) {
  std::vector<Vote> votes;
  const double of_no_ribs = log_of_no_ribs(ribs, stretch);
  for (const Numbering& kind : kNumberings) {
    const int highest = place_count(kind) - 1 - stretch.places.back();
    for (int lowest = -1; lowest <= highest; ++lowest) {
      votes.push_back({&kind, lowest, log_likelihood(spine, ribs, stretch, kind, lowest, of_no_ribs)});
    }
  }
  return votes;
}

/// The levels that a body may be, the likeliest first. `place`: of the body above its stretch's first.
std::vector<LevelProbability> probabilities_of(const std::vector<Vote>& votes, const Vote& likeliest, int place) {
  constexpr double kTold = 0.01;
  std::map<Level, double> of_level;
  double whole = 0.0;
  for (const Vote& vote : votes) {
    const double weight = std::exp(vote.log_likelihood - likeliest.log_likelihood);
    whole += weight;
    if (vote.lowest_place + place >= 0) of_level[level_at(*vote.kind, vote.lowest_place + place)] += weight;
  }
  std::vector<LevelProbability> probabilities;
  for (const auto& [level, weight] : of_level) {
    if (weight / whole >= kTold) probabilities.push_back({level, weight / whole});
  }
  std::stable_sort(probabilities.begin(), probabilities.end(),
                   [](const LevelProbability& a, const LevelProbability& b) { return a.probability > b.probability; });
  return probabilities;
}

/// The likeliest where that is likely enough to be a name.
Level named(const std::vector<LevelProbability>& probabilities) {
  constexpr double kNamed = 0.9;
  if (probabilities.empty() || probabilities.front().probability < kNamed ||
      probabilities.front().level == Level::kSacrum)
    return Level::kNone;
  return probabilities.front().level;
}

/// What is said of a kind of people with another number of vertebrae than most between the last ribs and the sacrum.
std::string transitional_of(const Numbering& kind) {
  constexpr int kUsualBetween = 5;
  const int between = static_cast<int>(kind.lowest) - static_cast<int>(kind.last_ribs);
  if (between == kUsualBetween) return {};
  return joined("a transitional spine: between the last ribs and the sacrum lie likeliest ", between,
                " vertebrae, not ", kUsualBetween, "; names may be off by one");
}

/// From below upward levels only rise.
bool levels_rise(const std::vector<Level>& levels) {
  Level below = Level::kNone;
  for (const Level level : levels) {
    if (level == Level::kNone) continue;
    if (below != Level::kNone && level_rank(level) >= level_rank(below)) return false;
    below = level;
  }
  return true;
}

/// Whether ribs or a sacrum name a stretch: sizes alone do not.
bool has_witness(const SpineBodies& spine, const std::vector<Ribs>& ribs, const Stretch& stretch) {
  if (stretch.first == 0 && spine.has_sacrum) return true;
  const auto at = [&](std::size_t m) { return ribs[stretch.first + m]; };
  for (std::size_t m = 0; m + 1 < stretch.places.size(); ++m) {
    const bool lower = at(m) == Ribs::both, upper = at(m + 1) == Ribs::both;
    if ((lower && at(m + 1) == Ribs::none) || (upper && at(m) == Ribs::none)) return true;
  }
  return false;
}

/// The ribs of a body that the CT cuts may lie beyond it.
std::vector<Ribs> within_ct(const SpineBodies& spine, std::vector<Ribs> ribs) {
  for (std::size_t n = 0; n < ribs.size(); ++n) {
    if (spine.chain[n].is_cut() && ribs[n] == Ribs::none) ribs[n] = Ribs::unknown;
  }
  return ribs;
}

}  // namespace

std::vector<Level> levels_counted_from(const SpineBodies& spine, std::size_t index, Level level) {
  std::vector<Level> levels(spine.bodies.size(), Level::kNone);
  levels[index] = level;
  const auto count_on = [&](std::size_t from, std::size_t to, Level (*next)(Level)) {
    const std::optional<int> missing = bodies_missing_above(spine, std::min(from, to));
    if (!missing) return;
    levels[to] = levels[from];
    for (int step = 0; step <= *missing; ++step) levels[to] = next(levels[to]);
  };
  for (std::size_t n = index + 1; n < levels.size(); ++n) count_on(n - 1, n, level_above);
  for (std::size_t n = index; n-- > 0;) count_on(n + 1, n, level_below);
  return levels;
}

LevelNames voted_names(const SpineBodies& spine, const std::vector<Ribs>& found_ribs) {
  const std::vector<Ribs> ribs = within_ct(spine, found_ribs);
  LevelNames names;
  names.levels.assign(spine.bodies.size(), Level::kNone);
  names.probabilities.resize(spine.bodies.size());
  const std::size_t lowest = spine.has_sacrum ? 1 : 0;  // of the vertebrae
  if (spine.has_sacrum) names.levels[0] = Level::kSacrum;
  for (const Stretch& stretch : stretches_of(spine)) {
    const std::vector<Vote> votes = votes_of(spine, ribs, stretch);
    const auto likeliest = std::max_element(
        votes.begin(), votes.end(), [](const Vote& a, const Vote& b) { return a.log_likelihood < b.log_likelihood; });
    if (likeliest == votes.end()) continue;
    const bool is_witnessed = has_witness(spine, ribs, stretch);
    for (std::size_t m = 0; m < stretch.places.size(); ++m) {
      const std::size_t n = stretch.first + m;
      if (n < lowest) continue;
      names.probabilities[n] = probabilities_of(votes, *likeliest, stretch.places[m]);
      if (is_witnessed) names.levels[n] = named(names.probabilities[n]);
    }
    if (!is_witnessed) continue;
    if (std::string word = transitional_of(*likeliest->kind); !word.empty()) names.transitional = std::move(word);
  }
  if (levels_rise(names.levels)) return names;
  // One stretch is misnamed, and nothing tells which.
  std::fill(names.levels.begin() + static_cast<std::ptrdiff_t>(lowest), names.levels.end(), Level::kNone);
  return names;
}

std::string in_words(const std::vector<LevelProbability>& probabilities) {
  TextWriter text;
  for (std::size_t n = 0; n < probabilities.size(); ++n) {
    const double rounded = std::round(100.0 * probabilities[n].probability) / 100.0;
    text << (n == 0 ? "" : ", ") << level_name(probabilities[n].level) << ' ' << rounded;
  }
  return text.str();
}

}  // namespace spinaltap
