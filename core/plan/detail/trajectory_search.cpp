#include "core/plan/detail/trajectory_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace spinaltap::detail {
namespace {

constexpr double kStepMm = 0.5;
/// Here at the latest, before the isthmus, a screw is all in the bone.
constexpr double kEntryOpeningMm = 4.0;
/// So far behind and ahead of the isthmus a pedicle and its canal go.
constexpr double kPedicleMm = 10.0;

double share(double value, double full) { return std::clamp(value / full, 0.0, 1.0); }

/// Depths below the surface along a line through the bone, behind and ahead of the isthmus.
struct DepthLine {
  std::vector<double> ahead_mm;   ///< at 0, kStepMm, ... as long as there is bone
  std::vector<double> behind_mm;  ///< at -kStepMm, -2 kStepMm, ...

  double entry_mm() const { return -kStepMm * static_cast<double>(behind_mm.size()); }
  double exit_mm() const { return kStepMm * static_cast<double>(ahead_mm.size()); }
};

std::vector<double> depths_until_out(const BoneShape& bone, const Vec3& start_mm, const Vec3& step_mm) {
  constexpr std::size_t kMax = 200;
  std::vector<double> depths_mm;
  while (depths_mm.size() < kMax) {
    const double depth_mm = -bone.lattice_mm(start_mm + static_cast<double>(depths_mm.size()) * step_mm);
    if (!(depth_mm > 0.0)) break;
    depths_mm.push_back(depth_mm);
  }
  return depths_mm;
}

/// Whether a straight tool can come to the entry from behind.
bool is_open_behind(const BoneShape& bone, const Vec3& entry_mm, const Vec3& direction) {
  constexpr double kReachMm = 60.0;
  for (double way_mm = 2.0 * kStepMm; way_mm <= kReachMm; way_mm += kStepMm) {
    if (bone.lattice_mm(entry_mm - way_mm * direction) < 0.0) return false;
  }
  return true;
}

/// The place where the bone begins on the way from a place outside to one inside.
Vec3 surface_between(const BoneShape& bone, Vec3 outside_mm, Vec3 inside_mm) {
  for (int halving = 0; halving < 20; ++halving) {
    const Vec3 middle_mm = 0.5 * (outside_mm + inside_mm);
    (bone.is_inside(middle_mm) ? inside_mm : outside_mm) = middle_mm;
  }
  return inside_mm;
}

/// Ways that are better come first; of equal ones that of the first place in the lattice.
bool is_better(const ScrewCandidate& a, const ScrewCandidate& b) {
  const auto key = [](const ScrewCandidate& w) {
    return std::array{-w.score, w.trajectory.across_mm, w.trajectory.up_mm, w.trajectory.turn_deg,
                      w.trajectory.rise_deg};
  };
  return key(a) < key(b);
}

bool are_neighbours(const Trajectory& a, const Trajectory& b) {
  return std::abs(a.across_mm - b.across_mm) < 1.0 && std::abs(a.up_mm - b.up_mm) < 1.5 &&
         std::abs(a.turn_deg - b.turn_deg) < 5.0 && std::abs(a.rise_deg - b.rise_deg) < 5.0;
}

}  // namespace

TrajectorySearch::TrajectorySearch(const WallDistance& walls, const HuSampler& hu, std::span<const PedicleScrew> screws,
                                   const SuggestOptions& options, double side)
    : walls_(walls),
      hu_(hu),
      screws_(screws),
      options_(options),
      side_(side),
      pedicle_(side > 0.0 ? walls.landmarks().left_pedicle : walls.landmarks().right_pedicle) {}

std::optional<ScrewCandidate> TrajectorySearch::with_screw(const Trajectory& trajectory) const {
  const BoneShape& bone = walls_.bone();
  const Landmarks& marks = walls_.landmarks();
  const Vec3 direction = (pedicle_.axis + std::tan(trajectory.turn_deg * kDegree) * pedicle_.width_axis +
                          std::tan(trajectory.rise_deg * kDegree) * pedicle_.height_axis)
                             .normalized();
  const Vec3 crossing_mm =
      pedicle_.isthmus_mm + trajectory.across_mm * pedicle_.width_axis + trajectory.up_mm * pedicle_.height_axis;
  DepthLine line;
  line.ahead_mm = depths_until_out(bone, crossing_mm, kStepMm * direction);
  line.behind_mm = depths_until_out(bone, crossing_mm - kStepMm * direction, -kStepMm * direction);
  constexpr auto kEntryOpening = static_cast<std::ptrdiff_t>(kEntryOpeningMm / kStepMm);
  constexpr auto kThrough = static_cast<std::ptrdiff_t>(kPedicleMm / kStepMm);
  if (std::ssize(line.behind_mm) <= kEntryOpening || std::ssize(line.ahead_mm) <= kThrough) return std::nullopt;
  const double pedicle_depth_mm =
      std::min(*std::min_element(line.behind_mm.begin(), line.behind_mm.begin() + kEntryOpening),
               *std::min_element(line.ahead_mm.begin(), line.ahead_mm.begin() + kThrough));
  const double widest_mm =
      std::min(2.0 * (pedicle_depth_mm - options_.margin_mm), options_.widest_share * pedicle_.width_mm * (1.0 + 1e-9));
  double diameter_mm = 0.0;
  for (const PedicleScrew& screw : screws_) {
    if (screw.diameter_mm <= widest_mm) diameter_mm = std::max(diameter_mm, screw.diameter_mm);
  }
  if (!(diameter_mm > 0.0)) return std::nullopt;
  const double radius_mm = 0.5 * diameter_mm;

  // As far ahead as bone around the screw, bone before its tip, the body's depth and the midsagittal plane allow.
  const double back_of_body_mm = marks.to_own(marks.body.centre_mm).y() + 0.5 * marks.body.depth_mm;
  const double furthest_y_mm = back_of_body_mm - options_.furthest_share * marks.body.depth_mm;
  double tip_mm = 0.0;
  for (std::size_t n = 0; n < line.ahead_mm.size(); ++n) {
    const double at_mm = kStepMm * static_cast<double>(n);
    const Vec3 own_mm = marks.to_own(crossing_mm + at_mm * direction);
    if (line.ahead_mm[n] < radius_mm + options_.margin_mm || at_mm > line.exit_mm() - options_.front_margin_mm ||
        own_mm.y() < furthest_y_mm || side_ * own_mm.x() < radius_mm) {
      break;
    }
    tip_mm = at_mm;
  }
  const PedicleScrew* screw = nullptr;
  for (const PedicleScrew& other : screws_) {
    if (other.diameter_mm != diameter_mm || line.entry_mm() + other.length_mm > tip_mm) continue;
    if (screw == nullptr || other.length_mm > screw->length_mm) screw = &other;
  }
  // A screw that ends in the pedicle holds nothing.
  if (screw == nullptr || line.entry_mm() + screw->length_mm < kPedicleMm) return std::nullopt;
  const Vec3 outside_mm = crossing_mm + (line.entry_mm() - kStepMm) * direction;
  const Vec3 entry_mm = surface_between(bone, outside_mm, outside_mm + 2.0 * kStepMm * direction);
  if (!is_open_behind(bone, entry_mm, direction)) return std::nullopt;
  ScrewCandidate found;
  found.trajectory = trajectory;
  found.path = {side_ > 0.0 ? "left" : "right", entry_mm, entry_mm + screw->length_mm * direction, options_.bit,
                *screw};
  found.score = score(found.path, pedicle_depth_mm);
  return found;
}

double TrajectorySearch::score(const DrillPath& path, double pedicle_depth_mm) const {
  // Of the axis, not of the thread: else thin screws would be worth more.
  const double half_width_mm = 0.5 * pedicle_.width_mm;
  const double enough_to_canal_mm = 1.2 * half_width_mm;
  constexpr double kEnoughToEndplateMm = 9.0;
  constexpr double kDenseHu = 350.0;
  constexpr double kTurnedDeg = 15.0;
  const SuggestWeights& weights = options_.weights;
  const Landmarks& marks = walls_.landmarks();
  const Landmarks::Body& body = marks.body;
  const double radius_mm = path.screw->radius_mm();
  const Vec3 direction = path.direction();

  const double back_of_body_mm = marks.to_own(body.centre_mm).y() + 0.5 * body.depth_mm;
  const double in_body_mm = back_of_body_mm - marks.to_own(path.target_mm).y();
  double canal_mm = enough_to_canal_mm;
  const double crossing_mm = (pedicle_.isthmus_mm - path.entry_mm).dot(direction);
  for (double at_mm = -kPedicleMm; at_mm <= kPedicleMm; at_mm += 2.0) {
    canal_mm = std::min(canal_mm, walls_.canal(path.entry_mm + (crossing_mm + at_mm) * direction).distance_mm);
  }
  double endplate_mm = kEnoughToEndplateMm;
  for (const double at : {0.5, 0.75, 1.0}) {
    const Vec3 p_mm = path.entry_mm + at * path.length_mm() * direction;
    for (const EndplateLandmarks* plate : {&body.upper, &body.lower}) {
      endplate_mm = std::min(endplate_mm, plate->normal.dot(plate->centre_mm - p_mm));
    }
  }
  // Along the axis and four lines half-way to the thread.
  const Vec3 beside = any_perpendicular(direction);
  const Vec3 above = direction.cross(beside);
  std::vector<Vec3> places_mm;
  for (double at_mm = kEntryOpeningMm; at_mm < path.length_mm(); at_mm += 1.0) {
    const Vec3 p_mm = path.entry_mm + at_mm * direction;
    places_mm.push_back(p_mm);
    for (const Vec3& trajectory : {beside, above}) {
      places_mm.push_back(p_mm + 0.6 * radius_mm * trajectory);
      places_mm.push_back(p_mm - 0.6 * radius_mm * trajectory);
    }
  }
  std::vector<float> hu(places_mm.size());
  hu_(places_mm, hu);
  double sum_hu = 0.0;
  for (const float value : hu) sum_hu += static_cast<double>(value);

  const double turned_deg = std::acos(std::clamp(direction.dot(pedicle_.axis), -1.0, 1.0)) / kDegree;
  return weights.length * share(in_body_mm, options_.furthest_share * body.depth_mm) +
         weights.diameter * share(path.screw->diameter_mm, options_.widest_share * pedicle_.width_mm) +
         weights.clearance * share(pedicle_depth_mm, half_width_mm) +
         weights.canal * share(canal_mm, enough_to_canal_mm) +
         weights.endplates * share(endplate_mm, kEnoughToEndplateMm) +
         weights.density * share(sum_hu / static_cast<double>(hu.size()), kDenseHu) +
         weights.along_axis * (1.0 - share(turned_deg * turned_deg, kTurnedDeg * kTurnedDeg));
}

ScrewCandidate TrajectorySearch::refined(ScrewCandidate best, std::size_t& looked_at) const {
  constexpr int kHalvings = 4;
  Trajectory step{0.5, 0.75, 2.0, 2.0};
  for (int halving = 0; halving < kHalvings; ++halving) {
    for (bool goes_on = true; goes_on;) {
      goes_on = false;
      for (double Trajectory::*of :
           {&Trajectory::across_mm, &Trajectory::up_mm, &Trajectory::turn_deg, &Trajectory::rise_deg}) {
        for (const double sign : {-1.0, 1.0}) {
          Trajectory trajectory = best.trajectory;
          trajectory.*of += sign * step.*of;
          if (std::max(std::abs(trajectory.turn_deg), std::abs(trajectory.rise_deg)) > options_.max_turn_deg) continue;
          ++looked_at;
          const std::optional<ScrewCandidate> other = with_screw(trajectory);
          if (!other || !(other->score > best.score + 1e-6)) continue;
          best = *other;
          goes_on = true;
        }
      }
    }
    for (double Trajectory::*of :
         {&Trajectory::across_mm, &Trajectory::up_mm, &Trajectory::turn_deg, &Trajectory::rise_deg})
      step.*of *= 0.5;
  }
  return best;
}

std::vector<ScrewCandidate> TrajectorySearch::find(std::size_t max, const Progress& progress) {
  constexpr int kAcross = 3;  // to each side
  constexpr int kUp = 4;
  constexpr double kTurnStepDeg = 4.0;
  const int turns = static_cast<int>(options_.max_turn_deg / kTurnStepDeg);
  std::vector<Trajectory> trajectories;
  for (int across = -kAcross; across <= kAcross; ++across) {
    for (int up = -kUp; up <= kUp; ++up) {
      const double x = static_cast<double>(across) / kAcross;
      const double y = static_cast<double>(up) / kUp;
      if (x * x + y * y > 1.0) continue;
      for (int turn = -turns; turn <= turns; ++turn) {
        for (int rise = -turns; rise <= turns; ++rise) {
          trajectories.push_back(
              {0.3 * pedicle_.width_mm * x, 0.35 * pedicle_.height_mm * y, kTurnStepDeg * turn, kTurnStepDeg * rise});
        }
      }
    }
  }
  looked_at_ += trajectories.size();
  std::vector<std::optional<ScrewCandidate>> found(trajectories.size());
  ProgressCounter counter(progress, "looking for paths", trajectories.size());
  tbb::parallel_for(std::size_t{0}, trajectories.size(), [&](std::size_t n) {
    found[n] = with_screw(trajectories[n]);
    counter.add();
  });
  std::vector<ScrewCandidate> good;
  for (const auto& one : found) {
    if (one) good.push_back(*one);
  }
  std::sort(good.begin(), good.end(), is_better);
  std::vector<ScrewCandidate> chosen;
  for (const ScrewCandidate& one : good) {
    if (chosen.size() == max) break;
    const bool is_new = std::none_of(chosen.begin(), chosen.end(), [&](const ScrewCandidate& other) {
      return are_neighbours(one.trajectory, other.trajectory);
    });
    if (is_new) chosen.push_back(one);
  }
  std::vector<std::size_t> looked_at(chosen.size(), 0);
  tbb::parallel_for(std::size_t{0}, chosen.size(),
                    [&](std::size_t n) { chosen[n] = refined(chosen[n], looked_at[n]); });
  for (const std::size_t count : looked_at) looked_at_ += count;
  std::sort(chosen.begin(), chosen.end(), is_better);
  return chosen;
}

}  // namespace spinaltap::detail
