#include "core/plan/detail/fast_breach.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>

#include "core/plan/detail/inside_bone.h"
#include "core/plan/instrument.h"

namespace spinaltap {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
/// What stands between the nearest sample and the surface's nearest place.
constexpr double kSampleSquared = BoneShape::kSampleMm * BoneShape::kSampleMm;

/// By how much bone may be thinner than the lattice says. Between its samples a distance to points, D, bends by 1/D to
/// each side at most, which is h²/8 (2/D) of error for a spacing h: 0.06 mm a millimetre from the points. Where
/// samples are distances they may be 0.1 mm more than them.
double lattice_error_mm(const BoneShape& bone, double lattice_mm) {
  constexpr double kDeepErrorMm = 0.2;
  return lattice_mm < -std::max(2.0, bone.trusted_band_mm() + 1.0) ? kDeepErrorMm : kSureLatticeMm;
}

double value_at(const BoneShape& bone, const Vec3& p_mm) {
  double value_mm = 0.0;
  bone.surface().evaluate({&p_mm, 1}, {&value_mm, 1}, {});
  return value_mm;
}

}  // namespace

BreachField::BreachField(const WallDistance& walls, const GradeOptions& options)
    : walls_(walls),
      step_mm_(options.step_mm),
      turns_(options.ring_points),
      side_turns_(kSideRingPoints),
      cells_(walls.bone().tree()) {
  measure_canal();
}

void BreachField::measure_canal() {
  constexpr double kSpacingMm = 2.0;
  std::vector<Vec3> canal_mm;
  for (std::size_t n = 0; n < bone().points_mm().size(); ++n) {
    if (walls_.landmarks().is_canal_wall[n] != 0) canal_mm.push_back(bone().points_mm()[n]);
  }
  if (canal_mm.empty()) return;
  const PointTree tree(std::move(canal_mm));
  GridGeometry& geometry = canal_squared_mm2_.geometry;
  geometry.origin_mm = bone().bounds_mm().min() - Vec3::Constant(kSpacingMm);
  geometry.spacing_mm = Vec3::Constant(kSpacingMm);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double side_mm = bone().bounds_mm().sizes()[static_cast<Eigen::Index>(axis)] + 2.0 * kSpacingMm;
    geometry.size[axis] = static_cast<int>(std::ceil(side_mm / kSpacingMm)) + 1;
  }
  canal_squared_mm2_.values.resize(geometry.voxel_count());
  tbb::parallel_for(0, geometry.size[2], [&](int k) {
    std::size_t guess = PointTree::Nearest{}.index;
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const PointTree::Nearest found = tree.nearest(geometry.to_patient(Vec3(i, j, k)), guess);
        guess = found.index;
        canal_squared_mm2_.values[geometry.offset(i, j, k)] = static_cast<float>(found.distance_mm * found.distance_mm);
      }
    }
  });
}

double BreachField::canal_at_least_mm(const Vec3& p_mm) const {
  if (canal_squared_mm2_.values.empty()) return kUnbounded;
  // |p - s|² - |p|² is linear in p for each sample s. The least of it over the samples is therefore concave, and what
  // is interpolated between lattice places is not above it: only |p|² has to be corrected for its bend.
  const GridGeometry& geometry = canal_squared_mm2_.geometry;
  const Vec3 index = (p_mm - geometry.origin_mm).cwiseQuotient(geometry.spacing_mm);
  double bend_mm2 = 0.0, outside_squared = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double last = geometry.size[static_cast<std::size_t>(axis)] - 1;
    const double inside = std::clamp(index[axis], 0.0, last);
    const double share = inside - std::floor(inside);
    const double spacing_squared = geometry.spacing_mm[axis] * geometry.spacing_mm[axis];
    bend_mm2 += share * (1.0 - share) * spacing_squared;
    outside_squared += (index[axis] - inside) * (index[axis] - inside) * spacing_squared;
  }
  constexpr double kRoundingShare = 1e-5;  // of float
  const double squared_mm2 =
      sample_clamped(canal_squared_mm2_, index) * (1.0 - kRoundingShare) - bend_mm2 - kSampleSquared;
  return squared_mm2 > 0.0 ? std::max(0.0, std::sqrt(squared_mm2) - std::sqrt(outside_squared)) : 0.0;
}

FastBreach::FastBreach(const BreachField& field, const DrillPath& path)
    : field_(field), bone_(field.bone()), tool_(path), sides_(field.walls().landmarks(), path) {
  const double length_mm = tool_.length_mm(), step_mm = field.step_mm();
  rows_.reserve(static_cast<std::size_t>(length_mm / step_mm) + 2);
  double deep_until_mm = 0.0;
  const auto add = [&](double depth_mm) {
    Row row{depth_mm, -1.0, 0.0, depth_mm < deep_until_mm, kNone};
    if (!row.is_deep) {
      row.lattice_mm = bone_.lattice_mm(tool_.axis_mm(depth_mm));
      // As deep as that, what follows is deep enough for a while.
      deep_until_mm = depth_mm - row.lattice_mm - lattice_error_mm(bone_, row.lattice_mm) - tool_.widest_mm();
      row.is_deep = depth_mm < deep_until_mm;
    }
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

FastBreach::Axis& FastBreach::axis_of(Row& row) {
  if (row.axis != kNone) return axes_[row.axis];
  row.axis = axes_.size();
  Axis& axis = axes_.emplace_back();
  const Vec3 p_mm = tool_.axis_mm(row.depth_mm);
  const std::size_t sample = field_.nearest(p_mm);
  if (field_.walls().landmarks().is_canal_wall[sample] == 0) {
    axis.nearer = WallDistance::wall_at(p_mm, bone_.points_mm()[sample], bone_.normals()[sample]);
    if (field_.canal_at_least_mm(p_mm) > axis.nearer.distance_mm) {
      const double value_mm = value_at(bone_, p_mm);
      if (std::abs(value_mm) < bone_.trusted_band_mm()) axis.nearer.distance_mm = std::abs(value_mm);
      if (value_mm > 0.0) axis.nearer.distance_mm = -axis.nearer.distance_mm;
      return axis;
    }
  }
  axis.both = last_both_ = field_.walls().walls(p_mm, last_both_);
  axis.is_canal = axis.both->canal.distance_mm < axis.both->outer.distance_mm;
  axis.nearer = axis.is_canal ? axis.both->canal : axis.both->outer;
  return axis;
}

const WallDistance::Walls& FastBreach::both_of(Row& row) {
  Axis& axis = axis_of(row);
  if (!axis.both) axis.both = last_both_ = field_.walls().walls(tool_.axis_mm(row.depth_mm), last_both_);
  return *axis.both;
}

double FastBreach::max_breach_mm(Row& row) const {
  if (row.is_deep) return 0.0;
  // Outside, the lattice has no more than the sign; the way along the axis to where it is in the bone is a bound.
  if (row.lattice_mm > -kSureLatticeMm) {
    if (first_in_ == rows_.size()) return kUnbounded;
    return radius_mm(row) + std::abs(row.depth_mm - rows_[first_in_].depth_mm) + kSureLatticeMm;
  }
  const double error_mm = lattice_error_mm(bone_, row.lattice_mm);
  if (tool_.widest_mm() + row.lattice_mm + error_mm <= 0.0) return 0.0;
  return radius_mm(row) + row.lattice_mm + error_mm;
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
  const double sure_mm = kSureLatticeMm + 1.1 * std::numbers::pi * radius_mm / static_cast<double>(count);
  const ToolRing ring(tool_, row.depth_mm, radius_mm, tool_.across_at(row.depth_mm));
  for (std::size_t n = 0; n < count; n += kEvery) {
    const std::size_t place = (last_cut_ + n) % count;
    if (bone_.lattice_mm(ring.place_mm(turns.cosines[place], turns.sines[place])) < sure_mm) continue;
    last_cut_ = place;
    return true;
  }
  return false;
}

bool FastBreach::is_whole(Row& row) {
  if (row.is_deep) return true;
  const double r_mm = radius_mm(row);
  if (row.lattice_mm < -r_mm - lattice_error_mm(bone_, row.lattice_mm)) return true;
  if (!is_in(row)) return false;
  if (r_mm > 0.0 && is_surely_cut(row, r_mm)) return false;
  const Vec3 centre_mm = tool_.axis_mm(row.depth_mm);
  if (!(r_mm > 0.0)) return true;
  const Axis& axis = axis_of(row);
  const ToolRing ring(tool_, row.depth_mm, r_mm,
                      SideNames::towards(centre_mm, axis.is_canal ? axis.both->outer : axis.nearer));
  const RingTurns& turns = field_.turns();
  std::vector<Vec3> suspect_mm;
  suspect_mm.reserve(turns.cosines.size());
  for (std::size_t n = 0; n < turns.cosines.size(); ++n) {
    const Vec3 p_mm = ring.place_mm(turns.cosines[n], turns.sines[n]);
    const double lattice_mm = bone_.lattice_mm(p_mm);
    if (lattice_mm > kSureLatticeMm) return false;
    if (lattice_mm >= -kSureLatticeMm) suspect_mm.push_back(p_mm);
  }
  if (suspect_mm.empty()) return true;
  std::vector<double> values_mm(suspect_mm.size());
  bone_.surface().evaluate(suspect_mm, values_mm, {});
  return std::all_of(values_mm.begin(), values_mm.end(), [](double value_mm) { return value_mm < 0.0; });
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

WallDistance::Beyond FastBreach::beyond(const Vec3& p_mm, std::size_t guess, double least_mm) const {
  WallDistance::Beyond none;
  none.wall.sample = guess;
  const double band_mm = bone_.trusted_band_mm();
  const double to_guess_mm = guess == kNone ? kUnbounded : (p_mm - bone_.points_mm()[guess]).norm();
  if (std::max(to_guess_mm, band_mm) <= least_mm || bone_.lattice_mm(p_mm) < -kSureLatticeMm) return none;
  const double value_mm = value_at(bone_, p_mm);
  if (!(value_mm > 0.0) || (value_mm < band_mm ? value_mm : to_guess_mm) <= least_mm) return none;
  return field_.walls().beyond_sample(p_mm, value_mm, field_.nearest(p_mm));
}

template <class Visit>
void FastBreach::for_each_place(Row& row, const RingTurns& turns, const Visit& visit) {
  const double r_mm = radius_mm(row);
  const Vec3 centre_mm = tool_.axis_mm(row.depth_mm);
  if (!(r_mm > 0.0)) {
    visit(centre_mm);
    return;
  }
  const ToolRing ring(tool_, row.depth_mm, r_mm, SideNames::towards(centre_mm, axis_of(row).nearer));
  for (std::size_t n = 0; n < turns.cosines.size(); ++n) visit(ring.place_mm(turns.cosines[n], turns.sines[n]));
}

FoundBreaches FastBreach::find() {
  // As find_breaches(): the ring with the largest possible breach first. What is possible is known from the lattice,
  // and exactly from the walls as seen from the axis, which are asked for when it is a row's turn.
  struct Candidate {
    double max_mm;
    std::size_t row;
    bool is_exact;

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
    if (max_mm > 0.0) candidates.push_back({max_mm, n, false});
  }
  std::priority_queue<Candidate> queue(std::less<Candidate>(), std::move(candidates));
  std::size_t guess = kNone;
  while (!queue.empty()) {
    Candidate top = queue.top();
    queue.pop();
    if (!(top.max_mm > std::min(best.outer.breach_mm, best.canal.breach_mm))) break;
    Row& row = rows_[top.row];
    const bool is_opening = top.row < opening_rows_;
    const double within_mm = radius_mm(row) + top.max_mm;
    bool may_be_outer = !is_opening && top.max_mm > best.outer.breach_mm;
    bool may_be_canal = top.max_mm > best.canal.breach_mm;
    if (!top.is_exact) {
      if (!may_be_outer && !(may_be_canal && field_.canal_at_least_mm(tool_.axis_mm(row.depth_mm)) <= within_mm)) {
        continue;
      }
      top.max_mm = radius_mm(row) - axis_of(row).nearer.distance_mm;
      top.is_exact = true;
      if (top.max_mm > 0.0) queue.push(top);
      continue;
    }
    const Axis& axis = axis_of(row);
    // The nearer wall is always near enough.
    if (may_be_outer && axis.is_canal) may_be_outer = std::abs(axis.both->outer.distance_mm) <= within_mm;
    if (may_be_canal && !axis.is_canal) {
      may_be_canal = field_.canal_at_least_mm(tool_.axis_mm(row.depth_mm)) <= within_mm &&
                     std::abs(both_of(row).canal.distance_mm) <= within_mm;
    }
    if (!may_be_outer && !may_be_canal) continue;
    for_each_place(row, field_.turns(), [&](const Vec3& p_mm) {
      const double least_mm =
          std::min(may_be_outer ? best.outer.breach_mm : kUnbounded, may_be_canal ? best.canal.breach_mm : kUnbounded);
      const WallDistance::Beyond found = beyond(p_mm, guess, least_mm);
      guess = found.wall.sample;
      if (is_opening && !found.is_canal) return;
      FoundBreach& of_wall = found.is_canal ? best.canal : best.outer;
      if (!(found.distance_mm > of_wall.breach_mm)) return;
      of_wall = {found.distance_mm, row.depth_mm, found.is_canal, p_mm, found.wall};
    });
  }
  sharpen_breach(bone_, best.outer);
  sharpen_breach(bone_, best.canal);
  return best;
}

std::array<double, 5> FastBreach::sides(const FoundBreaches& found) {
  std::array<double, 5> breach_mm{};
  if (!(found.larger().breach_mm > 0.0)) return breach_mm;
  const auto add = [&](double mm, const Vec3& place_mm, const WallDistance::Wall& wall) {
    double& side_mm = breach_mm[static_cast<std::size_t>(sides_.of(place_mm, wall))];
    side_mm = std::max(side_mm, mm);
  };
  for (const FoundBreach& known : {found.outer, found.canal}) {
    if (known.breach_mm > 0.0) add(known.breach_mm, known.place_mm, known.wall);
  }
  double next_mm = 0.0;
  std::size_t guess = kNone;
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    Row& row = rows_[n];
    if (row.depth_mm < next_mm && n + 1 < rows_.size()) continue;
    next_mm = row.depth_mm + kSideRingsApartMm - 1e-9;
    const double max_mm = max_breach_mm(row);
    if (!(max_mm > 0.0)) continue;
    const bool is_opening = n < opening_rows_;
    // The outer surface does not count there: is the canal's near enough?
    if (is_opening && field_.canal_at_least_mm(tool_.axis_mm(row.depth_mm)) > radius_mm(row) + max_mm + 0.5) continue;
    if (!(radius_mm(row) - axis_of(row).nearer.distance_mm > 0.0)) continue;
    for_each_place(row, field_.side_turns(), [&](const Vec3& p_mm) {
      const WallDistance::Beyond beside = beyond(p_mm, guess, 0.0);
      guess = beside.wall.sample;
      if (!(beside.distance_mm > 0.0) || (is_opening && !beside.is_canal)) return;
      add(beside.distance_mm, p_mm, beside.wall);
    });
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
