#include "core/segment/body_chain.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "core/base/error.h"
#include "core/segment/detail/median.h"

namespace spinaltap {
namespace {

constexpr double kPlaceStepMm = 0.5;  // between places of endplates
constexpr double kMinHeightMm = 5.0;  // of a crushed body, in slices so thin that they show it
constexpr double kMinCutMm = 2.5;     // of a body that the CT cuts
constexpr double kMaxHeightMm = 40.0;
constexpr double kMinGapMm = 0.5;
constexpr double kLeastEdge = 0.15;  // of an endplate, and of what is taken for one
constexpr double kMaxGapMm = 17.0;
// In noise the best of many tilts is better than it should be, and steep ones are rare.
constexpr double kLargeTilt = 25.0 * kDegree;
constexpr double kTiltCost = 0.12;

/// Tilts of an endplate against the column's section, in order of growing size so that the least of equals is taken.
struct Tilt {
  double pitch_rad, roll_rad;  ///< about the column's left and back
};

std::vector<Tilt> tilts() {
  std::vector<Tilt> all;
  for (const double pitch : {0.0, -6.0, 6.0, -12.0, 12.0, -18.0, 18.0, -25.0, 25.0, -33.0, 33.0}) {
    for (const double roll : {0.0, -6.0, 6.0, -12.0, 12.0, -18.0, 18.0}) {
      all.push_back({pitch * kDegree, roll * kDegree});
    }
  }
  return all;
}

double cost_of(const Tilt& tilt) {
  const double size = std::hypot(tilt.pitch_rad, tilt.roll_rad) / kLargeTilt;
  return kTiltCost * size * size;
}

/// Points of the unit disc that an endplate is judged by: its middle, where it is without rim and osteophytes.
std::vector<Eigen::Vector2d> disc_points() {
  constexpr int kCount = 44;
  constexpr double kShare = 0.72;
  std::vector<Eigen::Vector2d> points;
  for (int n = 0; n < kCount; ++n) {
    const double r = kShare * std::sqrt((n + 0.5) / kCount);
    const double turn = 2.0 * std::numbers::pi * n / std::numbers::phi;
    points.emplace_back(r * std::cos(turn), r * std::sin(turn));
  }
  return points;
}

/// What is known at each place along the column.
struct Profile {
  std::vector<float> rise, fall;  ///< of the best tilt: going up into bone, and out of it
  std::vector<std::uint16_t> rise_tilt, fall_tilt;
  std::vector<float> level;  ///< mean CT number across, untilted
  std::vector<float> wall;   ///< at the sides
  std::vector<float> half_size_mm;
  int first = 0, last = -1;  ///< the places whose middle lies within the CT
  std::vector<float> means;  ///< across the column, at each place for each tilt; an edge is a difference of two
};

Vec3 tilted_up(const ColumnSection& section, const Tilt& tilt) {
  return section.axes * Vec3(std::tan(tilt.roll_rad), std::tan(tilt.pitch_rad), 1.0).normalized();
}

/// The CT's voxels' step along the column.
double step_along_mm(const GridGeometry& geometry, const SpineColumn& column) {
  const Vec3 up = (column.sections.back().centre_mm - column.sections.front().centre_mm).normalized();
  return (geometry.directions.transpose() * up).cwiseAbs().cwiseProduct(geometry.spacing_mm).maxCoeff();
}

/// Over how many places to each side an endplate's edge is measured: 1 mm, across its outer edge and no further than
/// the middle of a thin disc, or half a step of voxels along the column, over which thick slices spread it.
std::size_t arm_places(double step_mm) {
  constexpr double kArmMm = 1.0;
  return static_cast<std::size_t>(std::lround(std::max(kArmMm, 0.5 * step_mm) / kPlaceStepMm));
}

/// In slices of 1.2 mm and more a thin disc may not be seen between its endplates: the three are one bright band, up to
/// 10 mm wide. Its middle is taken for a disc of 2 mm then. `gain`: of edges, as strengthen() has it.
void add_bands(Profile& profile, const std::vector<Tilt>& kinds, double full_drop_hu, double step_mm, double gain) {
  constexpr double kSideMm = 6.5;   // from the band into the bodies
  constexpr std::size_t kHalf = 2;  // places: half of the disc
  const auto side = static_cast<std::size_t>(std::lround(std::max(kSideMm, step_mm) / kPlaceStepMm));
  const std::size_t count = profile.level.size();
  std::vector<float> band(count, 0.0F);
  std::vector<std::uint16_t> tilt(count, 0);
  for (std::size_t n = side; n + side < count; ++n) {
    for (std::size_t t = 0; t < kinds.size(); ++t) {
      const auto at = [&](std::size_t place) { return static_cast<double>(profile.means[place * kinds.size() + t]); };
      const double over = at(n) - std::max(at(n - side), at(n + side));
      const auto strength = static_cast<float>(std::min(gain * over / full_drop_hu, 1.0) - cost_of(kinds[t]));
      if (strength <= band[n]) continue;
      band[n] = strength;
      tilt[n] = static_cast<std::uint16_t>(t);
    }
  }
  const std::vector<float> level = profile.level;
  for (std::size_t n = side; n + side < count; ++n) {
    const auto peak = std::max_element(band.begin() + static_cast<std::ptrdiff_t>(n - 2),
                                       band.begin() + static_cast<std::ptrdiff_t>(n + 3));
    if (*peak < static_cast<float>(kLeastEdge) || *peak != band[n]) continue;
    if (band[n] > profile.rise[n + kHalf]) {
      profile.rise[n + kHalf] = band[n];
      profile.rise_tilt[n + kHalf] = tilt[n];
    }
    if (band[n] > profile.fall[n - kHalf]) {
      profile.fall[n - kHalf] = band[n];
      profile.fall_tilt[n - kHalf] = tilt[n];
    }
    // As dark as a disc is beside its bodies.
    for (std::size_t m = n - kHalf; m <= n + kHalf; ++m) {
      profile.level[m] = std::min(profile.level[m], std::min(level[n - side], level[n + side]));
    }
  }
}

/// Makes edges stronger where all are weak: thick slices and soft kernels spread them, and noise asks for blur. By how
/// much is returned.
double strengthen(Profile& profile) {
  constexpr int kWindow = 40;  // places, 20 mm: a body or a disc at least
  constexpr double kEnough = 0.5, kMaxGain = 2.5;
  std::vector<float> best;
  for (const std::vector<float>* edges : {&profile.rise, &profile.fall}) {
    for (int n = profile.first; n + kWindow <= profile.last + 1; n += kWindow / 2) {
      best.push_back(*std::max_element(edges->begin() + n, edges->begin() + n + kWindow));
    }
  }
  if (best.empty()) return 1.0;
  const auto middle = static_cast<double>(detail::upper_median(std::move(best)));
  const double gain = std::clamp(kEnough / std::max(middle, 0.01), 1.0, kMaxGain);
  if (gain == 1.0) return gain;
  for (std::vector<float>* edges : {&profile.rise, &profile.fall}) {
    for (float& edge : *edges) edge = static_cast<float>(std::min(1.0, gain * static_cast<double>(edge)));
  }
  return gain;
}

Profile make_profile(const WallProbe& probe, const SpineColumn& column, const WallLevels& levels,
                     const std::vector<Tilt>& kinds, double step_mm) {
  const std::vector<Eigen::Vector2d> disc = disc_points();
  const auto count = static_cast<std::size_t>(column.length_mm() / kPlaceStepMm) + 1;
  Profile profile;
  profile.rise.assign(count, 0.0F);
  profile.fall.assign(count, 0.0F);
  profile.rise_tilt.assign(count, 0);
  profile.fall_tilt.assign(count, 0);
  profile.level.assign(count, 0.0F);
  profile.wall.assign(count, 0.0F);
  profile.half_size_mm.assign(count, 0.0F);
  std::vector<std::uint8_t> in_ct(count, 0);
  std::vector<float>& means = profile.means;
  means.resize(count * kinds.size());
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t n) {
    const ColumnSection section = column.at(kPlaceStepMm * static_cast<double>(n));
    profile.half_size_mm[n] = static_cast<float>(std::sqrt(section.half_depth_mm * section.half_width_mm));
    profile.wall[n] = static_cast<float>(section.wall);
    const Eigen::Array3i nearest = probe.geometry().to_index(section.centre_mm).array().round().cast<int>();
    in_ct[n] = probe.geometry().contains(nearest.x(), nearest.y(), nearest.z()) ? 1 : 0;
    for (std::size_t t = 0; t < kinds.size(); ++t) {
      const double roll = std::tan(kinds[t].roll_rad);
      const double pitch = std::tan(kinds[t].pitch_rad);
      double sum = 0.0;
      for (const Eigen::Vector2d& p : disc) {
        const double x = p.x() * section.half_width_mm;
        const double y = p.y() * section.half_depth_mm;
        const Vec3 at = section.centre_mm + section.axes * Vec3(x, y, -roll * x - pitch * y);
        sum += std::clamp(probe.hu(at), -100.0, 600.0);
      }
      means[n * kinds.size() + t] = static_cast<float>(sum / static_cast<double>(disc.size()));
    }
    profile.level[n] = means[n * kinds.size()];
  });
  const auto first = std::find(in_ct.begin(), in_ct.end(), 1);
  const auto last = std::find(in_ct.rbegin(), in_ct.rend(), 1);
  profile.first = static_cast<int>(first - in_ct.begin());
  profile.last = static_cast<int>(in_ct.rend() - last) - 1;
  const std::size_t arm = arm_places(step_mm);
  for (std::size_t n = arm; n + arm < count; ++n) {
    for (std::size_t t = 0; t < kinds.size(); ++t) {
      const float below = means[(n - arm) * kinds.size() + t];
      const float above = means[(n + arm) * kinds.size() + t];
      const double cost = cost_of(kinds[t]);
      const double change = (static_cast<double>(above) - static_cast<double>(below)) / levels.full_drop_hu;
      const auto rise = static_cast<float>(std::min(change, 1.0) - cost);
      const auto fall = static_cast<float>(std::min(-change, 1.0) - cost);
      if (rise > profile.rise[n]) {
        profile.rise[n] = rise;
        profile.rise_tilt[n] = static_cast<std::uint16_t>(t);
      }
      if (fall > profile.fall[n]) {
        profile.fall[n] = fall;
        profile.fall_tilt[n] = static_cast<std::uint16_t>(t);
      }
    }
  }
  return profile;
}

/// Sums up to each place, for means over ranges.
std::vector<double> sums_of(const std::vector<float>& values) {
  std::vector<double> sums{0.0};
  for (const float value : values) sums.push_back(sums.back() + static_cast<double>(value));
  return sums;
}

/// The least height of a whole body: three slices, so that it is told from its endplates, and no more than 9 mm.
double min_height_mm(double step_mm) {
  constexpr double kSlices = 3.0, kMostMm = 9.0;
  return std::clamp(kSlices * step_mm, kMinHeightMm, kMostMm);
}

class ChainSearch {
 public:
  ChainSearch(const Profile& profile, const WallLevels& levels, double step_mm)
      : profile_(profile),
        levels_(levels),
        min_whole_(static_cast<int>(min_height_mm(step_mm) / kPlaceStepMm)),
        count_(static_cast<int>(profile.rise.size())),
        wall_sums_(sums_of(profile.wall)),
        level_sums_(sums_of(profile.level)) {}

  struct Body {
    int lower, upper;  ///< places of its ends
    bool lower_cut, upper_cut;
    double gain;
  };

  std::vector<Body> best_chain() const;

 private:
  static constexpr int kMinHeight = static_cast<int>(kMinCutMm / kPlaceStepMm);
  static constexpr int kMaxHeight = static_cast<int>(kMaxHeightMm / kPlaceStepMm);
  static constexpr int kHeights = kMaxHeight - kMinHeight + 1;
  static constexpr int kMinGap = static_cast<int>(kMinGapMm / kPlaceStepMm);
  static constexpr int kMaxGap = static_cast<int>(kMaxGapMm / kPlaceStepMm);

  double mean(const std::vector<double>& sums, int low, int high) const {
    return (sums[static_cast<std::size_t>(high)] - sums[static_cast<std::size_t>(low)]) / std::max(1, high - low);
  }

  /// What speaks for a body between two places, ends not counted.
  double body_gain(int lower, int upper, bool is_whole) const {
    const double height_mm = kPlaceStepMm * (upper - lower);
    const double size_mm =
        2.0 * static_cast<double>(profile_.half_size_mm[static_cast<std::size_t>((lower + upper) / 2)]);
    // A body's height over its size across, the root of width times depth: 0.65 to 0.85 from the neck to L5.
    const double off = std::log(height_mm / (0.74 * size_mm)) / 0.28;
    // A crushed body may be half as high and less: that is rare, and no reason to end a row.
    constexpr double kMaxShort = 1.8;
    const double size_cost = off > 0.0 ? 0.5 * off * off : is_whole ? std::min(0.5 * off * off, kMaxShort) : 0.0;
    constexpr int kRim = 4;  // 2 mm: rims may bridge
    const double wall = mean(wall_sums_, lower + kRim, std::max(lower + kRim + 1, upper - kRim));
    constexpr int kEnd = 8;    // 4 mm: wedged and hollow ends
    constexpr int kPlain = 2;  // 1 mm
    // What is beyond an end is no denser than what is within: else the edge is an endplate's inner face.
    const double within = mean(level_sums_, lower + kEnd, std::max(lower + kEnd + 1, upper - kEnd));
    double inverted = 0.0;
    for (const int beyond : {lower - kPlain, upper + kPlain}) {
      if (beyond < profile_.first || beyond > profile_.last) continue;
      const auto level = static_cast<double>(profile_.level[static_cast<std::size_t>(beyond)]);
      inverted += std::clamp((level - within - 80.0) / 80.0, 0.0, 1.0);
    }
    return 2.0 * std::clamp(wall - 0.15, -0.4, 0.4) - size_cost - inverted;
  }

  /// What speaks for a gap between two places.
  double gap_gain(int lower, int upper) const {
    const double height_mm = kPlaceStepMm * (upper - lower);
    const double size_mm =
        2.0 * static_cast<double>(profile_.half_size_mm[static_cast<std::size_t>((lower + upper) / 2)]);
    // A disc's height over that size: 0.1 in the upper thoracic spine to 0.3 in the lowest lumbar one.
    const double off = std::max(0.0, height_mm / size_mm - 0.26) / 0.12;
    const double wall = mean(wall_sums_, lower, upper);
    const double level = mean(level_sums_, lower, upper);
    // Soft inside: discs are darker than any endplate and than most cancellous bone.
    const double soft = std::clamp((levels_.bone_hu + 60.0 - level) / 150.0, -1.0, 0.5);
    return 0.6 * soft - 0.8 * std::clamp(wall - 0.15, -0.4, 0.4) - 0.5 * off * off;
  }

  /// Whether a body is so low for its size that it must be crushed, if it is one.
  bool is_crushed(int upper, int height) const {
    constexpr double kCrushed = 0.41;  // of its size across; 0.74 is usual
    const double size_mm =
        2.0 * static_cast<double>(profile_.half_size_mm[static_cast<std::size_t>(upper - height / 2)]);
    return kPlaceStepMm * height < kCrushed * size_mm;
  }

  double height_change_cost(int height, int other) const {
    const double off = std::log(static_cast<double>(height) / other) / 0.16;
    return 0.5 * std::min(off * off, 2.2);
  }

  const Profile& profile_;
  const WallLevels& levels_;
  int min_whole_;  ///< places
  int count_;
  std::vector<double> wall_sums_, level_sums_;
};

/// How much of the column bodies take, in places.
double places_of(const std::vector<ChainSearch::Body>& bodies) {
  double sum = 0.0;
  for (const ChainSearch::Body& body : bodies) sum += body.upper - body.lower;
  return sum;
}

double gain_of(const std::vector<ChainSearch::Body>& bodies) {
  double sum = 0.0;
  for (const ChainSearch::Body& body : bodies) sum += body.gain;
  return sum;
}

/// What an end costs that is not there, against a clear endplate's 1.
constexpr double kCutEnd = 0.0;
/// What each body must bring at least.
constexpr double kMinGain = 0.9;
constexpr double kMinCutGain = 0.4;  // of one that the CT cuts, which has one end only
/// What it costs to leave out a stretch in which no bodies are seen, as beside a crushed one: more than one body
/// brings.
constexpr double kSkipCost = 2.0;

std::vector<ChainSearch::Body> ChainSearch::best_chain() const {
  // State: a body that ends with its upper endplate at a place, of a height. Its gain is the best of all rows up to it.
  const auto states = static_cast<std::size_t>(count_) * kHeights;
  const auto state = [](int upper, int height) {
    return static_cast<std::size_t>(upper) * kHeights + static_cast<std::size_t>(height - kMinHeight);
  };
  constexpr double kNever = -1e9;
  std::vector<double> gain(states, kNever);
  std::vector<double> own(states, kNever);
  std::vector<int> from(states, -1);  // the state before; -1: the first body
  const double cut_mm = 1.5;          // ends so near to the column's are cut
  const int first_lower = profile_.first;
  const int last_upper = profile_.last;
  // Only the CT's border cuts; where the column ends within the CT, bodies have ends there too.
  const int cut_below = first_lower + static_cast<int>(cut_mm / kPlaceStepMm);
  const int cut_above = last_upper - static_cast<int>(cut_mm / kPlaceStepMm);
  // Of the rows that end at a place or below it, the best one's last body; -1: none.
  std::vector<int> best_below(static_cast<std::size_t>(count_), -1);
  for (int upper = first_lower; upper <= last_upper; ++upper) {
    auto& best_here = best_below[static_cast<std::size_t>(upper)];
    if (upper > first_lower) best_here = best_below[static_cast<std::size_t>(upper - 1)];
    const bool upper_cut = upper == last_upper && last_upper + 1 < count_;
    const double fall = upper_cut ? kCutEnd : static_cast<double>(profile_.fall[static_cast<std::size_t>(upper)]);
    if (!upper_cut && (fall < kLeastEdge || upper > cut_above)) continue;
    // Heights are independent of each other: each looks at all bodies before.
    tbb::parallel_for(kMinHeight, kMaxHeight + 1, [&](int height) {
      const int lower = upper - height;
      const bool lower_cut = lower <= first_lower && first_lower > 0;
      if (lower < first_lower) return;
      const double rise = lower_cut ? kCutEnd : static_cast<double>(profile_.rise[static_cast<std::size_t>(lower)]);
      if (!lower_cut && (rise < kLeastEdge || lower < cut_below)) return;
      if (!lower_cut && !upper_cut && height < min_whole_) return;
      const std::size_t here = state(upper, height);
      const bool is_whole = !lower_cut && !upper_cut;
      own[here] = rise + fall + body_gain(lower, upper, is_whole) - (is_whole ? kMinGain : kMinCutGain);
      double best = 0.0;
      const bool crushed_here = is_whole && is_crushed(upper, height);
      for (int gap = kMinGap; !lower_cut && gap <= kMaxGap && lower - gap >= first_lower; ++gap) {
        const int below = lower - gap;
        const double gap_here = gap_gain(below, lower);
        for (int other = kMinHeight; other <= kMaxHeight; ++other) {
          const double before = gain[state(below, other)];
          if (before <= 0.0) continue;
          const bool partial = upper_cut || lower_cut || (below - other <= first_lower && first_lower > 0);
          const bool is_free = partial || crushed_here || is_crushed(below, other);
          const double total = before + gap_here - (is_free ? 0.0 : height_change_cost(height, other));
          if (total <= best) continue;
          best = total;
          from[here] = static_cast<int>(state(below, other));
        }
      }
      // Where what lies between is no gap, the row goes on beyond it.
      const int beyond = lower - kMaxGap - 1;
      const int before = !lower_cut && beyond >= first_lower ? best_below[static_cast<std::size_t>(beyond)] : -1;
      if (before >= 0 && gain[static_cast<std::size_t>(before)] - kSkipCost > best) {
        best = gain[static_cast<std::size_t>(before)] - kSkipCost;
        from[here] = before;
      }
      gain[here] = own[here] + best;
    });
    for (int height = kMinHeight; height <= kMaxHeight; ++height) {
      const auto here = static_cast<int>(state(upper, height));
      const double so_far = best_here < 0 ? 0.0 : gain[static_cast<std::size_t>(best_here)];
      if (gain[static_cast<std::size_t>(here)] > so_far) best_here = here;
    }
  }
  std::vector<Body> chain;
  const auto best = std::max_element(gain.begin(), gain.end());
  if (best == gain.end() || *best <= 0.0) return chain;
  for (auto at = static_cast<int>(best - gain.begin()); at >= 0; at = from[static_cast<std::size_t>(at)]) {
    const int upper = at / kHeights;
    const int height = at % kHeights + kMinHeight;
    chain.push_back({upper - height, upper, upper - height <= first_lower && first_lower > 0,
                     upper == last_upper && last_upper + 1 < count_, own[static_cast<std::size_t>(at)]});
  }
  std::reverse(chain.begin(), chain.end());
  return chain;
}

/// Where a band was taken for a disc, but a fall and a rise show within it, the disc lies between these: it may be 5 mm
/// high. `plain`: without bands. What edges the band had is kept where neither shows.
void part_at_edges(std::vector<ChainSearch::Body>& row, Profile& profile, const Profile& plain) {
  constexpr int kReach = 8;    // places, 4 mm to either side of the band's middle
  constexpr int kMostGap = 6;  // what was taken for a disc in a band
  constexpr auto kLeast = static_cast<float>(kLeastEdge);
  for (std::size_t n = 0; n + 1 < row.size(); ++n) {
    ChainSearch::Body &below = row[n], &above = row[n + 1];
    if (above.lower - below.upper > kMostGap) continue;
    const int middle = (below.upper + above.lower) / 2;
    const int first = std::max(middle - kReach, plain.first), last = std::min(middle + kReach, plain.last);
    int best_fall = -1, best_rise = -1;
    float best = 0.0F;
    for (int fall = first; fall <= last; ++fall) {
      if (plain.fall[static_cast<std::size_t>(fall)] < kLeast) continue;
      for (int rise = fall + 1; rise <= last; ++rise) {
        const float here = plain.fall[static_cast<std::size_t>(fall)] + plain.rise[static_cast<std::size_t>(rise)];
        if (plain.rise[static_cast<std::size_t>(rise)] < kLeast || here <= best) continue;
        best = here;
        best_fall = fall;
        best_rise = rise;
      }
    }
    if (best_fall < 0) continue;
    const auto take = [](std::vector<float>& edges, std::vector<std::uint16_t>& tilts, const std::vector<float>& from,
                         const std::vector<std::uint16_t>& from_tilts, int place) {
      const auto at = static_cast<std::size_t>(place);
      edges[at] = from[at];
      tilts[at] = from_tilts[at];
    };
    take(profile.fall, profile.fall_tilt, plain.fall, plain.fall_tilt, best_fall);
    take(profile.rise, profile.rise_tilt, plain.rise, plain.rise_tilt, best_rise);
    below.upper = best_fall;
    above.lower = best_rise;
  }
}

/// Moves the cut end of a body to where it would be if the body were as high as the nearest whole one.
void complete(BodySpan& span, const std::vector<BodySpan>& chain) {
  constexpr double kHeightOverDepth = 0.85;
  double height_mm = kHeightOverDepth * 2.0 * span.middle.half_depth_mm;
  double nearest_mm = std::numeric_limits<double>::infinity();
  for (const BodySpan& other : chain) {
    const double away_mm = std::abs(other.lower.s_mm - span.lower.s_mm);
    if (other.is_cut() || away_mm >= nearest_mm) continue;
    nearest_mm = away_mm;
    height_mm = other.height_mm();
  }
  const double missing_mm = height_mm - span.height_mm();
  if (missing_mm <= 0.0) return;
  BodyEnd& end = span.lower.is_cut ? span.lower : span.upper;
  const double sign = span.lower.is_cut ? -1.0 : 1.0;
  end.centre_mm += sign * missing_mm * end.up;
  end.s_mm += sign * missing_mm;
}

}  // namespace

std::vector<BodySpan> find_body_chain(const FloatGrid& hu, const SpineColumn& column, const WallLevels& levels) {
  if (column.sections.size() < 2) fail("chain of bodies: expected a column of at least two sections");
  const WallProbe probe(hu, levels);
  const std::vector<Tilt> kinds = tilts();
  const double step_mm = step_along_mm(hu.geometry, column);
  Profile profile = make_profile(probe, column, levels, kinds, step_mm);
  constexpr double kThickMm = 1.2;
  std::optional<Profile> banded;
  const double gain = strengthen(profile);
  if (step_mm >= kThickMm) add_bands(banded.emplace(profile), kinds, levels.full_drop_hu, step_mm, gain);
  std::vector<ChainSearch::Body> row = ChainSearch(profile, levels, step_mm).best_chain();
  if (banded) {
    // Where discs are seen, as in most of the lumbar spine, bands would only be endplates.
    constexpr double kClearlyMore = 1.3;
    std::vector<ChainSearch::Body> more = ChainSearch(*banded, levels, step_mm).best_chain();
    if (places_of(more) > kClearlyMore * places_of(row) && gain_of(more) > kClearlyMore * gain_of(row)) {
      part_at_edges(more, *banded, profile);
      profile = std::move(*banded);
      row = std::move(more);
    }
  }
  std::vector<BodySpan> chain;
  for (const ChainSearch::Body& body : row) {
    const auto end = [&](int place, bool is_cut, const std::vector<float>& edges,
                         const std::vector<std::uint16_t>& edge_tilts) {
      BodyEnd found;
      found.s_mm = kPlaceStepMm * place;
      const ColumnSection section = column.at(found.s_mm);
      found.centre_mm = section.centre_mm;
      found.is_cut = is_cut;
      const auto n = static_cast<std::size_t>(place);
      found.up = is_cut ? Vec3(section.axes.col(2)) : tilted_up(section, kinds[edge_tilts[n]]);
      found.edge = is_cut ? 0.0 : static_cast<double>(edges[n]);
      return found;
    };
    BodySpan span;
    span.lower = end(body.lower, body.lower_cut, profile.rise, profile.rise_tilt);
    span.upper = end(body.upper, body.upper_cut, profile.fall, profile.fall_tilt);
    span.middle = column.at(0.5 * (span.lower.s_mm + span.upper.s_mm));
    span.gain = body.gain;
    chain.push_back(span);
  }
  const std::vector<BodySpan> as_found = chain;
  for (BodySpan& span : chain) {
    if (span.lower.is_cut != span.upper.is_cut) complete(span, as_found);
  }
  return chain;
}

}  // namespace spinaltap
