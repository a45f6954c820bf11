#include "core/grading/fast_breach.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>

#include "core/anatomy/inside_bone.h"
#include "core/grading/instrument.h"

namespace spinaltap {
namespace {

/// Rows whose nearest samples bound those between: every so many.
constexpr std::size_t kSampledApart = 4;
/// A place of the surface may be nearer than the nearest sample by as much, squared, mm².
constexpr double kBesideSquaredMm2 = BoneShape::kSampleMm * BoneShape::kSampleMm;

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// By how much bone may be thinner than the lattice says. Between its samples a distance to points, D, bends by 1/D to
/// each side at most, which is h²/8 (2/D) of error for a spacing h: 0.06 mm a millimetre from the points. Where
/// samples are distances they may be 0.1 mm more than them.
double lattice_error_mm(const BoneShape& bone, double lattice_mm) {
  constexpr double kDeepErrorMm = 0.2;
  return lattice_mm < -std::max(2.0, bone.trusted_band_mm() + 1.0) ? kDeepErrorMm : kSureLatticeMm;
}

/// Goes around a ring, and passes over places that are in the bone for sure.
class RingWalk {
 public:
  RingWalk(const BoneShape& bone, const ToolRing& ring, const RingTurns& turns, double radius_mm)
      : bone_(bone),
        ring_(ring),
        turns_(turns),
        apart_mm_(2.0 * std::numbers::pi * radius_mm / static_cast<double>(turns.cosines.size())) {}

  /// To the next place that is not passed over, from 0 on; false where there is none.
  bool next() {
    n_ += 1 + passed_;
    passed_ = 0;
    return n_ < turns_.cosines.size();
  }
  std::size_t turn() const { return n_; }
  Vec3 place_mm() const { return ring_.place_mm(turns_.cosines[n_], turns_.sines[n_]); }
  double lattice_mm(const Vec3& p_mm) {
    constexpr double kLatticeErrorMm = 0.6;  // also where it is deep
    const double lattice_mm = bone_.lattice_mm(p_mm);
    const double inside_mm = -lattice_mm - kLatticeErrorMm;
    if (inside_mm > apart_mm_) passed_ = static_cast<std::size_t>(inside_mm / apart_mm_);
    return lattice_mm;
  }

 private:
  const BoneShape& bone_;
  const ToolRing& ring_;
  const RingTurns& turns_;
  double apart_mm_;
  std::size_t n_ = std::numeric_limits<std::size_t>::max(), passed_ = 0;
};

double value_at(const BoneShape& bone, const Vec3& p_mm) {
  double value_mm = 0.0;
  bone.surface().evaluate({&p_mm, 1}, {&value_mm, 1}, {});
  return value_mm;
}

}  // namespace

FastBreach::FastBreach(const BreachField& field, const DrillPath& path)
    : field_(field), bone_(field.bone()), tool_(path), sides_(field.walls().landmarks(), path) {
  const double length_mm = tool_.length_mm(), step_mm = field.step_mm();
  rows_.reserve(static_cast<std::size_t>(length_mm / step_mm) + 2);
  double deep_until_mm = 0.0;
  const auto add = [&](double depth_mm) {
    Row row{depth_mm, -1.0, 0.0, 0.0, depth_mm < deep_until_mm};
    if (!row.is_deep) {
      row.lattice_mm = bone_.lattice_mm(tool_.axis_mm(depth_mm));
      // As deep as that, what follows is deep enough for a while.
      deep_until_mm = depth_mm - row.lattice_mm - lattice_error_mm(bone_, row.lattice_mm) - tool_.widest_mm();
      row.is_deep = depth_mm < deep_until_mm;
    }
    // Outside, the lattice has no more than the sign.
    const bool is_in = row.is_deep || row.lattice_mm < -kSureLatticeMm;
    row.inside_mm = is_in ? deep_until_mm - depth_mm + tool_.widest_mm() : -kUnbounded;
    rows_.push_back(row);
  };
  for (int n = 0; step_mm * n < length_mm - 1e-6; ++n) add(step_mm * n);
  add(length_mm);
  find_opening();
}

double FastBreach::radius_mm(Row& row) const {
  if (row.radius_mm < 0.0) row.radius_mm = tool_.radius_mm(row.depth_mm);
  return row.radius_mm;
}

void FastBreach::find_sample(Row& row) const {
  if (row.sample != kNone) return;
  const Vec3 p_mm = tool_.axis_mm(row.depth_mm);
  row.sample = field_.nearest(p_mm);
  row.squared_mm2 = (p_mm - field_.sample_mm(row.sample)).squaredNorm();
}

FastBreach::Axis& FastBreach::axis_of(Row& row) {
  if (row.axis != kNone) return axes_[row.axis];
  row.axis = axes_.size();
  Axis& axis = axes_.emplace_back();
  const Vec3 p_mm = tool_.axis_mm(row.depth_mm);
  find_sample(row);
  axis.is_canal = field_.is_canal(row.sample);
  axis.nearer = WallDistance::wall_at(p_mm, field_.sample_mm(row.sample), bone_.normals()[row.sample]);
  const double other_mm = axis.is_canal ? field_.outer_at_least_mm(p_mm) : field_.canal_at_least_mm(p_mm);
  if (other_mm > axis.nearer.distance_mm) {
    const double band_mm = bone_.trusted_band_mm();
    if (row.lattice_mm < -band_mm - kSureLatticeMm) return axis;  // the surface's value is below -band_mm
    const double value_mm = value_at(bone_, p_mm);
    if (std::abs(value_mm) < band_mm) axis.nearer.distance_mm = std::abs(value_mm);
    if (value_mm > 0.0) axis.nearer.distance_mm = -axis.nearer.distance_mm;
    return axis;
  }
  const WallDistance::Walls& both = both_of(row);
  axis.is_canal = both.canal.distance_mm < both.outer.distance_mm;
  axis.nearer = axis.is_canal ? both.canal : both.outer;
  return axis;
}

const WallDistance::Walls& FastBreach::both_of(Row& row) {
  Axis& axis = axis_of(row);
  if (!axis.both) {
    axis.both = last_both_ = field_.walls(tool_.axis_mm(row.depth_mm), last_both_, row.sample);
  }
  return *axis.both;
}

bool FastBreach::is_other_within(Row& row, double within_mm) {
  const Vec3 p_mm = tool_.axis_mm(row.depth_mm);
  const bool is_outer = axis_of(row).is_canal;
  if ((is_outer ? field_.outer_at_least_mm(p_mm) : field_.canal_at_least_mm(p_mm)) > within_mm) return false;
  // No further than the sample that was found last, which lies beside the place of the wall that was.
  WallDistance::Wall& last = is_outer ? last_both_.outer : last_both_.canal;
  if (last.sample != WallDistance::Wall{}.sample &&
      (p_mm - last.nearest_mm).norm() + BoneShape::kSampleMm <= within_mm) {
    return true;
  }
  if (const std::optional<WallDistance::Walls>& both = axis_of(row).both) {
    return std::abs((is_outer ? both->outer : both->canal).distance_mm) <= within_mm;
  }
  last = field_.walls().further(p_mm, !is_outer, last);
  return last.distance_mm <= within_mm;
}

double FastBreach::max_breach_mm(Row& row) const {
  if (row.is_deep || row.is_whole) return 0.0;
  // Outside, the lattice has no more than the sign; the way along the axis to where it is in the bone is a bound.
  if (row.lattice_mm > -kSureLatticeMm) {
    if (first_in_ == rows_.size()) return kUnbounded;
    return radius_mm(row) + std::abs(row.depth_mm - rows_[first_in_].depth_mm) + kSureLatticeMm;
  }
  const double error_mm = lattice_error_mm(bone_, row.lattice_mm);
  if (tool_.widest_mm() + row.lattice_mm + error_mm <= 0.0) return 0.0;
  return radius_mm(row) + row.lattice_mm + error_mm;
}

FastBreach::Beside FastBreach::max_beside(std::size_t n) {
  constexpr std::size_t kApart = 2, kFurthest = 8;
  Beside beside{kUnbounded, n};
  if (!tool_.curve().is_straight()) return beside;
  const Row& row = rows_[n];
  const double r_mm = radius_mm(rows_[n]);
  const auto see_from = [&](std::size_t other) {
    const double way_mm = rows_[other].depth_mm - row.depth_mm;
    const double max_mm = std::sqrt(r_mm * r_mm + way_mm * way_mm) - rows_[other].inside_mm;
    if (max_mm < beside.max_mm) beside = {max_mm, other};
  };
  for (std::size_t apart = kApart; apart <= kFurthest; apart += kApart) {
    if (n >= apart) see_from(n - apart);
    if (n + apart < rows_.size()) see_from(n + apart);
  }
  return beside;
}

double FastBreach::closer_max_beside_mm(std::size_t n, std::size_t other) {
  constexpr double kSpareMm = 0.05;  // by which a place's distance may differ from the nearest sample's plane, and more
  Row& from = rows_[other];
  if (!(from.inside_mm > 0.0)) return kUnbounded;
  find_sample(from);
  const double r_mm = radius_mm(rows_[n]), way_mm = from.depth_mm - rows_[n].depth_mm;
  return std::sqrt(r_mm * r_mm + way_mm * way_mm) - std::sqrt(std::max(0.0, from.squared_mm2 - kBesideSquaredMm2)) +
         kSpareMm;
}

double FastBreach::closer_max_breach_mm(std::size_t n) {
  Row& row = rows_[n];
  // Nearer to the surface its value counts, and not the samples.
  if (!tool_.curve().is_straight() || row.lattice_mm > -bone_.trusted_band_mm() - kSureLatticeMm) return kUnbounded;
  Row& before = rows_[n / kSampledApart * kSampledApart];
  Row& after = rows_[std::min(n / kSampledApart * kSampledApart + kSampledApart, rows_.size() - 1)];
  find_sample(before);
  double squared_mm2 = before.squared_mm2;
  if (row.depth_mm > before.depth_mm) {
    // Along a line, squared distances to samples less the square of the way are linear: the least of them is concave.
    find_sample(after);
    const double behind_mm = row.depth_mm - before.depth_mm, ahead_mm = after.depth_mm - row.depth_mm;
    const double share = behind_mm / (behind_mm + ahead_mm);
    squared_mm2 += share * (after.squared_mm2 - before.squared_mm2) - behind_mm * ahead_mm;
  }
  constexpr double kRoundingMm2 = 1e-6;
  return radius_mm(row) - std::sqrt(std::max(0.0, squared_mm2 - kBesideSquaredMm2 - kRoundingMm2));
}

bool FastBreach::is_in(const Row& row) const {
  if (row.is_deep) return true;
  if (std::abs(row.lattice_mm) > kSureLatticeMm) return row.lattice_mm < 0.0;
  return value_at(bone_, tool_.axis_mm(row.depth_mm)) < 0.0;
}

bool FastBreach::is_surely_cut(const Row& row, double radius_mm) {
  constexpr std::size_t kEvery = 4;
  const RingTurns& turns = field_.turns();
  const std::size_t count = turns.cosines.size();
  // A ring has a place within half a gap of any place, and what is further out than that is out there too.
  const double gap_mm = 1.1 * std::numbers::pi * radius_mm / static_cast<double>(count);
  const double sure_mm = kSureLatticeMm + gap_mm;
  const ToolRing ring(tool_, row.depth_mm, radius_mm, tool_.across_at(row.depth_mm));
  // What is in doubt by the lattice the surface itself may say.
  const auto is_cut_at = [&](std::size_t place, double lattice_mm) {
    return lattice_mm > gap_mm && gap_mm < bone_.trusted_band_mm() &&
           value_at(bone_, ring.place_mm(turns.cosines[place], turns.sines[place])) > gap_mm;
  };
  double highest_mm = -kSureLatticeMm;
  std::size_t highest = count;
  const std::size_t first = last_cut_;
  for (std::size_t n = 0; n < count; n += kEvery) {
    const std::size_t place = (first + n) % count;
    const double lattice_mm = bone_.lattice_mm(ring.place_mm(turns.cosines[place], turns.sines[place]));
    if (lattice_mm > highest_mm) {
      highest_mm = lattice_mm;
      highest = place;
    }
    if (highest_mm < sure_mm && !(n == 0 && is_cut_at(place, lattice_mm))) continue;
    last_cut_ = highest;
    return true;
  }
  // What is in doubt by the lattice the surface itself may say.
  if (highest == count || gap_mm >= bone_.trusted_band_mm()) return false;
  last_cut_ = highest;
  return value_at(bone_, ring.place_mm(turns.cosines[highest], turns.sines[highest])) > gap_mm;
}

bool FastBreach::is_whole(Row& row) {
  if (row.is_deep) return true;
  const double r_mm = radius_mm(row);
  if (row.lattice_mm < -r_mm - lattice_error_mm(bone_, row.lattice_mm)) return true;
  if (!is_in(row)) return false;
  if (r_mm > 0.0 && is_surely_cut(row, r_mm)) return false;
  const Vec3 centre_mm = tool_.axis_mm(row.depth_mm);
  if (!(r_mm > 0.0)) return true;
  const ToolRing ring(tool_, row.depth_mm, r_mm,
                      SideNames::towards(centre_mm, axis_of(row).is_canal ? both_of(row).outer : axis_of(row).nearer));
  suspect_mm_.clear();
  for (RingWalk walk(bone_, ring, field_.turns(), r_mm); walk.next();) {
    const Vec3 p_mm = walk.place_mm();
    const double lattice_mm = walk.lattice_mm(p_mm);
    if (lattice_mm > kSureLatticeMm) return false;
    if (lattice_mm >= -kSureLatticeMm) suspect_mm_.push_back(p_mm);
  }
  const std::span<const double> values_mm = suspect_values_mm();
  const bool is_whole = std::all_of(values_mm.begin(), values_mm.end(), [](double value_mm) { return value_mm < 0.0; });
  row.is_whole = is_whole && !axis_of(row).is_canal;
  return is_whole;
}

std::span<const double> FastBreach::suspect_values_mm() {
  values_mm_.resize(suspect_mm_.size());
  if (!suspect_mm_.empty()) bone_.surface().evaluate(suspect_mm_, values_mm_, {});
  return values_mm_;
}

void FastBreach::find_opening() {
  first_in_ = 0;
  while (first_in_ < rows_.size() && !is_in(rows_[first_in_])) ++first_in_;
  opening_rows_ = 0;
  if (first_in_ == rows_.size()) return;
  const double end_mm = rows_[first_in_].depth_mm + opening_limit_mm(tool_.widest_mm());
  opening_rows_ = first_in_;
  while (opening_rows_ < rows_.size() && rows_[opening_rows_].depth_mm < end_mm && !is_whole(rows_[opening_rows_])) {
    ++opening_rows_;
  }
}

bool FastBreach::may_be_anterior(const Vec3& p_mm, std::size_t sample) const {
  // As SideNames::of() asks, with something to spare.
  constexpr double kSpare = 1e-6, kAhead = 0.5 - kSpare;
  const Landmarks& landmarks = field_.walls().landmarks();
  const Vec3& normal = bone_.normals()[sample];
  const Vec3 way_mm = p_mm - bone_.points_mm()[sample];
  const double across_mm = way_mm.dot(normal);
  if (!tool_.curve().is_straight() || std::abs(across_mm) < kSpare) return true;
  const Vec3& direction = tool_.curve().chord();
  const bool runs_forward = -direction.dot(landmarks.posterior()) > kAhead;
  // The way of SideNames::towards() is the normal, or comes from the foot on the sample's plane, or from the sample.
  const std::array<Vec3, 3> ways{normal, across_mm > 0.0 ? normal : Vec3(-normal), way_mm.normalized()};
  return std::any_of(ways.begin(), ways.end(), [&](const Vec3& way) {
    const Vec3 own = landmarks.axes.transpose() * way;
    return -own.y() > std::max(std::abs(own.x()), std::abs(own.z())) - kSpare ||
           (runs_forward && way.dot(direction) > kAhead);
  });
}

template <class LeastMm, class MayMatter, class Visit>
void FastBreach::for_each_beyond(Row& row, const RingTurns& turns, const LeastMm& least_mm, const MayMatter& may_matter,
                                 const Visit& visit) {
  const double r_mm = radius_mm(row), band_mm = bone_.trusted_band_mm();
  const Vec3 centre_mm = tool_.axis_mm(row.depth_mm);
  // A place is out by no more than any sample is away. Near ones: the axis' own, those of the places before it and of
  // the first on this ring, and that of the same turn on the ring before.
  turn_samples_.resize(turns.cosines.size(), kNone);
  std::size_t first = kNone, last = kNone;
  const auto at_most_mm = [&](const Vec3& p_mm, std::size_t turn) {
    double squared_mm2 = kUnbounded;
    for (const std::size_t sample : {row.sample, first, last, turn_samples_[turn]}) {
      if (sample == kNone) continue;
      squared_mm2 = std::min(squared_mm2, (p_mm - field_.sample_mm(sample)).squaredNorm());
    }
    return std::max(std::sqrt(squared_mm2), band_mm);
  };
  suspect_mm_.clear();
  suspect_turns_.clear();
  if (r_mm > 0.0) {
    const ToolRing ring(tool_, row.depth_mm, r_mm, SideNames::towards(centre_mm, axis_of(row).nearer));
    for (RingWalk walk(bone_, ring, turns, r_mm); walk.next();) {
      const Vec3 p_mm = walk.place_mm();
      const double most_mm = at_most_mm(p_mm, walk.turn());
      if (most_mm <= least_mm() || walk.lattice_mm(p_mm) < -kSureLatticeMm || !may_matter(p_mm, most_mm)) continue;
      suspect_mm_.push_back(p_mm);
      suspect_turns_.push_back(walk.turn());
    }
  } else {
    suspect_mm_.push_back(centre_mm);
    suspect_turns_.push_back(0);
  }
  // Those that are out of the bone, each with its value.
  const std::span<const double> values_mm = suspect_values_mm();
  std::size_t count = 0;
  for (std::size_t n = 0; n < values_mm.size(); ++n) {
    const double value_mm = values_mm[n];
    if (!(value_mm > 0.0) || (value_mm < band_mm && value_mm <= least_mm())) continue;
    values_mm_[count] = value_mm;
    suspect_mm_[count] = suspect_mm_[n];
    suspect_turns_[count++] = suspect_turns_[n];
  }
  field_.expect({suspect_mm_.data(), count});
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3& p_mm = suspect_mm_[n];
    const std::size_t turn = suspect_turns_[n];
    if ((values_mm_[n] < band_mm ? values_mm_[n] : at_most_mm(p_mm, turn)) <= least_mm()) continue;
    const std::size_t sample = turn_samples_[turn] = last = field_.nearest(p_mm);
    if (first == kNone) first = sample;
    visit(p_mm, values_mm_[n], sample);
  }
}

FoundBreaches FastBreach::find() {
  // As find_breaches(): the ring with the largest possible breach first. What is possible is known from the lattice,
  // and exactly from the walls as seen from the axis, which are asked for when it is a row's turn.
  enum class Known { lattice, closer, exact };
  constexpr double kDoubtMm = 0.25;  // what a lattice may leave in doubt
  struct Candidate {
    double max_mm;  ///< as find_breaches() has it, or more: the order in which rings come
    Beside beside;  ///< the most of it, whatever the order
    std::size_t row;
    Known by;

    bool operator<(const Candidate& other) const {
      if (max_mm != other.max_mm) return max_mm < other.max_mm;
      return row > other.row;
    }
  };
  FoundBreaches best;
  std::vector<Candidate> candidates;
  candidates.reserve(rows_.size());
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    const double max_mm = max_breach_mm(rows_[n]);
    if (!(max_mm > 0.0)) continue;
    const Beside beside = max_beside(n);
    if (beside.max_mm > 0.0) candidates.push_back({max_mm, beside, n, Known::lattice});
  }
  suspect_mm_.clear();
  std::size_t expected = kNone;
  for (const Candidate& candidate : candidates) {
    const std::size_t sampled = candidate.row / kSampledApart * kSampledApart;
    if (sampled == expected) continue;
    expected = sampled;
    suspect_mm_.push_back(tool_.axis_mm(rows_[sampled].depth_mm));
  }
  field_.expect(suspect_mm_);
  std::priority_queue<Candidate> queue(std::less<Candidate>(), std::move(candidates));
  turn_samples_.clear();
  while (!queue.empty()) {
    Candidate top = queue.top();
    queue.pop();
    if (!(top.max_mm > std::min(best.outer.breach_mm, best.canal.breach_mm))) break;
    Row& row = rows_[top.row];
    const bool is_opening = top.row < opening_rows_;
    const double most_mm = std::min(top.max_mm, top.beside.max_mm);
    const double within_mm = radius_mm(row) + most_mm;
    bool may_be_outer = !is_opening && most_mm > best.outer.breach_mm;
    bool may_be_canal = most_mm > best.canal.breach_mm;
    if (!may_be_outer && !may_be_canal) continue;
    if (top.by != Known::exact) {
      if (!may_be_outer && !(may_be_canal && field_.canal_at_least_mm(tool_.axis_mm(row.depth_mm)) <= within_mm)) {
        continue;
      }
      const bool is_closer = top.by == Known::closer;
      top.max_mm = is_closer ? radius_mm(row) - axis_of(row).nearer.distance_mm
                             : std::min(top.max_mm, closer_max_breach_mm(top.row));
      top.by = is_closer ? Known::exact : Known::closer;
      if (!is_closer && top.beside.max_mm < kDoubtMm) {
        top.beside.max_mm = std::min(top.beside.max_mm, closer_max_beside_mm(top.row, top.beside.from));
      }
      if (top.max_mm > 0.0 && top.beside.max_mm > 0.0) queue.push(top);
      continue;
    }
    // The nearer wall is always near enough.
    const bool nearer_is_canal = axis_of(row).is_canal;
    if (may_be_outer && nearer_is_canal) may_be_outer = is_other_within(row, within_mm);
    if (may_be_canal && !nearer_is_canal) may_be_canal = is_other_within(row, within_mm);
    if (!may_be_outer && !may_be_canal) continue;
    const auto least_mm = [&] {
      return std::min(may_be_outer ? best.outer.breach_mm : kUnbounded,
                      may_be_canal ? best.canal.breach_mm : kUnbounded);
    };
    // Of places near to one wall for sure only that one's breach counts.
    const auto may_matter = [&](const Vec3& p_mm, double at_most_mm) {
      const bool to_outer = !is_opening && at_most_mm > best.outer.breach_mm;
      const bool to_canal = at_most_mm > best.canal.breach_mm;
      if (to_outer && to_canal) return true;
      return (to_canal && field_.canal_at_least_mm(p_mm) <= at_most_mm) ||
             (to_outer && field_.outer_at_least_mm(p_mm) <= at_most_mm);
    };
    const auto visit = [&](const Vec3& p_mm, double value_mm, std::size_t sample) {
      if (is_opening && !field_.is_canal(sample)) return;
      const WallDistance::Beyond found = field_.walls().beyond_sample(p_mm, value_mm, sample);
      FoundBreach& of_wall = found.is_canal ? best.canal : best.outer;
      if (!(found.distance_mm > of_wall.breach_mm)) return;
      of_wall = {found.distance_mm, row.depth_mm, found.is_canal, p_mm, found.wall};
    };
    for_each_beyond(row, field_.turns(), least_mm, may_matter, visit);
  }
  sharpen_breach(bone_, best.outer);
  sharpen_breach(bone_, best.canal);
  return best;
}

std::array<double, 5> FastBreach::sides(const FoundBreaches& found, ScrewSides wanted) {
  std::array<double, 5> breach_mm{};
  if (!(found.larger().breach_mm > 0.0)) return breach_mm;
  const auto add = [&](double mm, const Vec3& place_mm, const WallDistance::Wall& wall) {
    double& side_mm = breach_mm[static_cast<std::size_t>(sides_.of(place_mm, wall))];
    side_mm = std::max(side_mm, mm);
  };
  for (const FoundBreach& known : {found.outer, found.canal}) {
    if (known.breach_mm > 0.0) add(known.breach_mm, known.place_mm, known.wall);
  }
  const double& anterior_mm = breach_mm[static_cast<std::size_t>(PathSide::anterior)];
  const bool is_all = wanted == ScrewSides::all;
  const auto least_mm = [&] { return is_all ? 0.0 : anterior_mm; };
  turn_samples_.clear();
  double next_mm = 0.0;
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    Row& row = rows_[n];
    if (row.depth_mm < next_mm && n + 1 < rows_.size()) continue;
    next_mm = row.depth_mm + kSideRingsApartMm - 1e-9;
    const double max_mm = max_breach_mm(row);
    if (!(max_mm > 0.0) || !(max_beside(n).max_mm > 0.0)) continue;
    const bool is_opening = n < opening_rows_;
    // The outer surface does not count there: is the canal's near enough?
    if (is_opening && field_.canal_at_least_mm(tool_.axis_mm(row.depth_mm)) > radius_mm(row) + max_mm + 0.5) continue;
    if (!(radius_mm(row) - axis_of(row).nearer.distance_mm > 0.0)) continue;
    const auto may_matter = [&](const Vec3& p_mm, double at_most_mm) {
      return !is_opening || field_.canal_at_least_mm(p_mm) <= at_most_mm;
    };
    const auto visit = [&](const Vec3& p_mm, double value_mm, std::size_t sample) {
      if (is_opening && !field_.is_canal(sample)) return;
      if (!is_all && !may_be_anterior(p_mm, sample)) return;
      const WallDistance::Beyond beside = field_.walls().beyond_sample(p_mm, value_mm, sample);
      if (beside.distance_mm > 0.0) add(beside.distance_mm, p_mm, beside.wall);
    };
    for_each_beyond(row, field_.side_turns(), least_mm, may_matter, visit);
  }
  return breach_mm;
}

double FastBreach::clearance_mm() {
  constexpr double kBeforeIsthmusMm = 4.0;
  const double latest_mm = tool_.along_mm(sides_.pedicle().isthmus_mm) - kBeforeIsthmusMm;
  std::size_t bearing = opening_rows_;
  while (bearing < rows_.size() && rows_[bearing].depth_mm < latest_mm && !is_whole(rows_[bearing])) ++bearing;
  std::size_t first = bearing;
  for (; first < rows_.size() && rows_[first].depth_mm < latest_mm; ++first) {
    const Vec3 nearest_mm = field_.walls().outer(tool_.axis_mm(rows_[first].depth_mm)).nearest_mm;
    if (tool_.along_mm(nearest_mm) >= rows_[bearing].depth_mm) break;
  }
  double clearance_mm = kUnbounded;
  for (std::size_t n = first; n < rows_.size(); ++n) {
    clearance_mm = std::min(clearance_mm, -bone_.lattice_mm(tool_.axis_mm(rows_[n].depth_mm)) - radius_mm(rows_[n]));
  }
  return std::max(0.0, clearance_mm);
}

}  // namespace spinaltap
