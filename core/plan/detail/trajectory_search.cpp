#include "core/plan/detail/trajectory_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "core/anatomy/bone_shape.h"
#include "core/anatomy/landmarks.h"
#include "core/grading/instrument.h"

namespace spinaltap::detail {
namespace {

constexpr double kStepMm = 0.5;
/// Here at the latest, before the isthmus, a screw is all in the bone.
constexpr double kEntryOpeningMm = 4.0;
/// So far behind and ahead of the isthmus a pedicle and its canal go.
constexpr double kPedicleMm = 10.0;
/// No bit begins on a surface that slants more.
constexpr double kSteepestDeg = 60.0;
/// So far from the joint surface a screw enters.
constexpr double kBesideJointMm = 0.75;

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

/// Places around an axis for tests of the lattice's sign.
std::array<Vec3, 8> rim_of(const Vec3& direction, double radius_mm) {
  const Vec3 u = any_perpendicular(direction);
  const Vec3 v = direction.cross(u);
  std::array<Vec3, 8> rim;
  for (int n = 0; n < 8; ++n) {
    const double angle = std::numbers::pi / 4.0 * n;
    rim[static_cast<std::size_t>(n)] = radius_mm * (std::cos(angle) * u + std::sin(angle) * v);
  }
  return rim;
}

/// Whether a straight tool's core, half as wide as it, can come to the entry from behind.
bool is_open_behind(const BoneShape& bone, const Vec3& entry_mm, const Vec3& direction, double radius_mm) {
  constexpr double kReachMm = 60.0;
  const std::array<Vec3, 8> rim_mm = rim_of(direction, 0.5 * radius_mm);
  const double opening_mm = opening_limit_mm(radius_mm);
  for (double way_mm = 2.0 * kStepMm; way_mm <= kReachMm; way_mm += kStepMm) {
    const Vec3 p_mm = entry_mm - way_mm * direction;
    if (bone.lattice_mm(p_mm) < 0.0) return false;
    if (way_mm < opening_mm) continue;
    if (std::any_of(rim_mm.begin(), rim_mm.end(), [&](const Vec3& r) { return bone.lattice_mm(p_mm + r) < 0.0; })) {
      return false;
    }
  }
  return true;
}

/// Whether the tool's whole section is in bone between two places along it, by the lattice.
bool is_borne(const BoneShape& bone, const Vec3& entry_mm, const Vec3& direction, double radius_mm, double from_mm,
              double to_mm) {
  constexpr double kApartMm = 1.0;
  const std::array<Vec3, 8> rim_mm = rim_of(direction, radius_mm);
  for (double at_mm = from_mm; at_mm <= to_mm; at_mm += kApartMm) {
    const Vec3 p_mm = entry_mm + at_mm * direction;
    if (std::any_of(rim_mm.begin(), rim_mm.end(), [&](const Vec3& r) { return bone.lattice_mm(p_mm + r) > 0.0; })) {
      return false;
    }
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

/// Between a direction and the surface's normal at a place, over the bit's width, from the lattice's gradient.
double slant_deg(const BoneShape& bone, const Vec3& p_mm, const Vec3& direction) {
  constexpr double kAcrossMm = 0.75;
  Vec3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = kAcrossMm * Vec3::Unit(axis);
    slope[axis] = bone.lattice_mm(p_mm + step) - bone.lattice_mm(p_mm - step);
  }
  if (!(slope.norm() > 0.0)) return 90.0;
  return std::acos(std::clamp(-slope.normalized().dot(direction), -1.0, 1.0)) / kDegree;
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

/// A trajectory as a line through the bone.
struct TrajectorySearch::Line {
  Vec3 crossing_mm;  ///< of the isthmus
  Vec3 direction;
};

TrajectorySearch::TrajectorySearch(const WallDistance& walls, const HuSampler& hu, std::span<const PedicleScrew> screws,
                                   const SuggestOptions& options, double side)
    : walls_(walls),
      hu_(hu),
      screws_(screws),
      options_(options),
      side_(side),
      pedicle_(side > 0.0 ? walls.landmarks().left_pedicle : walls.landmarks().right_pedicle),
      reference_(pedicle_.axis) {
  if (options.sagittal == SagittalReference::anatomic) return;
  // In the plane of the upper endplate, as far inward as the pedicle's axis.
  const Vec3& plate = walls.landmarks().body.upper.normal;
  const Vec3 level = pedicle_.axis - pedicle_.axis.dot(plate) * plate;
  if (!(level.norm() > 0.5)) return;
  reference_ = level.normalized();
  reference_rise_deg_ = std::atan2(reference_.dot(pedicle_.height_axis), reference_.dot(pedicle_.axis)) / kDegree;
}

TrajectorySearch::Line TrajectorySearch::line_of(const Trajectory& trajectory) const {
  return {pedicle_.isthmus_mm + trajectory.across_mm * pedicle_.width_axis + trajectory.up_mm * pedicle_.height_axis,
          (pedicle_.axis + std::tan(trajectory.turn_deg * kDegree) * pedicle_.width_axis +
           std::tan(trajectory.rise_deg * kDegree) * pedicle_.height_axis)
              .normalized()};
}

bool TrajectorySearch::is_on_joint(const Vec3& entry_mm, const Vec3& direction, double radius_mm) const {
  const BoneShape& bone = walls_.bone();
  const auto is_joint = [&](const Vec3& p_mm) {
    const PointTree::Nearest near = bone.nearest(p_mm);
    return walls_.parts().is_joint(bone.points_mm()[near.index], bone.normals()[near.index]);
  };
  if (is_joint(entry_mm)) return true;
  if (!(radius_mm > 0.0)) return false;
  const std::array<Vec3, 8> rim_mm = rim_of(direction, radius_mm);
  return std::any_of(rim_mm.begin(), rim_mm.end(), [&](const Vec3& r) { return is_joint(entry_mm + r); });
}

std::optional<ScrewCandidate> TrajectorySearch::with_screw(const Trajectory& trajectory, const Attempt& attempt,
                                                           const PedicleScrew* largest, ScrewLimit* limit) const {
  const auto none = [limit](ScrewLimit why) {
    if (limit != nullptr) *limit = why;
    return std::nullopt;
  };
  const BoneShape& bone = walls_.bone();
  const Landmarks& marks = walls_.landmarks();
  const auto [crossing_mm, direction] = line_of(trajectory);
  DepthLine line;
  line.ahead_mm = depths_until_out(bone, crossing_mm, kStepMm * direction);
  line.behind_mm = depths_until_out(bone, crossing_mm - kStepMm * direction, -kStepMm * direction);
  constexpr auto kEntryOpening = static_cast<std::ptrdiff_t>(kEntryOpeningMm / kStepMm);
  constexpr auto kThrough = static_cast<std::ptrdiff_t>(kPedicleMm / kStepMm);
  if (std::ssize(line.behind_mm) <= kEntryOpening || std::ssize(line.ahead_mm) <= kThrough) {
    return none(ScrewLimit::pedicle);
  }
  const double pedicle_depth_mm =
      std::min(*std::min_element(line.behind_mm.begin(), line.behind_mm.begin() + kEntryOpening),
               *std::min_element(line.ahead_mm.begin(), line.ahead_mm.begin() + kThrough));
  const double by_walls_mm = 2.0 * (pedicle_depth_mm - attempt.margin_mm);
  const double widest_mm = std::min(by_walls_mm, attempt.widest_share * pedicle_.width_mm * (1.0 + 1e-9));
  const Vec3 outside_mm = crossing_mm + (line.entry_mm() - kStepMm) * direction;
  const Vec3 entry_mm = surface_between(bone, outside_mm, outside_mm + 2.0 * kStepMm * direction);
  const double entry_at_mm = (entry_mm - crossing_mm).dot(direction);
  double diameter_mm = 0.0;
  bool is_narrow = true;
  for (const PedicleScrew& screw : screws_) {
    if (largest != nullptr && screw.diameter_mm > largest->diameter_mm) continue;
    if (screw.diameter_mm < attempt.least_diameter_mm) continue;
    if (screw.diameter_mm > widest_mm || screw.diameter_mm <= diameter_mm) continue;
    is_narrow = false;
    // Bone bears the whole section from the opening's end on.
    if (attempt.margin_mm >= 0.0 && !is_borne(bone, entry_mm, direction, screw.radius_mm(),
                                              opening_limit_mm(screw.radius_mm()), -entry_at_mm - kEntryOpeningMm)) {
      continue;
    }
    diameter_mm = screw.diameter_mm;
  }
  if (!(diameter_mm > 0.0)) {
    if (!is_narrow) return none(ScrewLimit::bearing);
    return none(by_walls_mm <= widest_mm ? ScrewLimit::pedicle : ScrewLimit::share);
  }
  const double radius_mm = 0.5 * diameter_mm;

  // As far ahead as bone around the screw, bone before its tip, the body's depth and the midsagittal plane allow.
  constexpr double kFarCortexMm = 0.5;
  const double front_margin_mm = options_.is_bicortical ? kFarCortexMm : options_.front_margin_mm;
  const double furthest_share = options_.is_bicortical ? 1.0 : options_.furthest_share;
  const double back_of_body_mm = marks.to_own(marks.body.centre_mm).y() + 0.5 * marks.body.depth_mm;
  const double furthest_y_mm = back_of_body_mm - furthest_share * marks.body.depth_mm;
  double tip_mm = 0.0;
  for (std::size_t n = 0; n < line.ahead_mm.size(); ++n) {
    const double at_mm = kStepMm * static_cast<double>(n);
    const Vec3 own_mm = marks.to_own(crossing_mm + at_mm * direction);
    // Near the far cortex the tip is a cone.
    const bool is_tip = options_.is_bicortical && at_mm > line.exit_mm() - radius_mm - attempt.margin_mm - 1.0;
    if ((!is_tip && line.ahead_mm[n] < radius_mm + attempt.margin_mm) || at_mm > line.exit_mm() - front_margin_mm ||
        own_mm.y() < furthest_y_mm || side_ * own_mm.x() < radius_mm) {
      break;
    }
    tip_mm = at_mm;
  }
  const PedicleScrew* screw = nullptr;
  for (const PedicleScrew& other : screws_) {
    if (other.diameter_mm != diameter_mm || entry_at_mm + other.length_mm > tip_mm) continue;
    if (largest != nullptr && other.length_mm > largest->length_mm) continue;
    if (screw == nullptr || other.length_mm > screw->length_mm) screw = &other;
  }
  // A screw that ends in the pedicle holds nothing.
  if (screw == nullptr || entry_at_mm + screw->length_mm < kPedicleMm) return none(ScrewLimit::length);
  if (attempt.margin_mm >= 0.0 && (is_on_joint(entry_mm, direction, radius_mm + kBesideJointMm) ||
                                   slant_deg(bone, entry_mm, direction) > kSteepestDeg)) {
    return none(ScrewLimit::entry);
  }
  if (!is_open_behind(bone, entry_mm, direction, radius_mm)) return none(ScrewLimit::way_in);
  ScrewCandidate found;
  found.trajectory = trajectory;
  found.path = {side_ > 0.0 ? "left" : "right", entry_mm, entry_mm + screw->length_mm * direction, options_.bit,
                *screw};
  found.score = score(found.path, pedicle_depth_mm, attempt);
  return found;
}

std::optional<ScrewCandidate> TrajectorySearch::beside_pedicle(const Trajectory& trajectory,
                                                               const Attempt& attempt) const {
  constexpr double kBehindMm = 40.0, kEntryBoneMm = 4.0, kThickestMm = 5.5;
  const BoneShape& bone = walls_.bone();
  const Landmarks& marks = walls_.landmarks();
  const auto [crossing_mm, direction] = line_of(trajectory);
  // The entry: the hindmost bone of the line.
  double entry_at_mm = 1.0;
  for (double at_mm = -kBehindMm; at_mm <= 0.0; at_mm += kStepMm) {
    if (!(bone.lattice_mm(crossing_mm + at_mm * direction) < 0.0)) continue;
    entry_at_mm = at_mm;
    break;
  }
  if (entry_at_mm > 0.0) return std::nullopt;
  const Vec3 first_mm = crossing_mm + entry_at_mm * direction;
  const Vec3 entry_mm = surface_between(bone, first_mm - kStepMm * direction, first_mm);
  entry_at_mm = (entry_mm - crossing_mm).dot(direction);
  for (double at_mm = kStepMm; at_mm < kEntryBoneMm; at_mm += kStepMm) {
    if (bone.lattice_mm(entry_mm + at_mm * direction) > 0.0) return std::nullopt;
  }
  if (is_on_joint(entry_mm, direction, 0.0)) return std::nullopt;
  // Nothing towards the canal but bone of the margin.
  double canal_mm = std::numeric_limits<double>::infinity();
  for (double at_mm = entry_at_mm; at_mm <= 1.5 * kPedicleMm; at_mm += 1.0) {
    canal_mm = std::min(canal_mm, walls_.canal(crossing_mm + at_mm * direction).distance_mm);
  }
  const double back_of_body_mm = marks.to_own(marks.body.centre_mm).y() + 0.5 * marks.body.depth_mm;
  const double furthest_y_mm = back_of_body_mm - options_.furthest_share * marks.body.depth_mm;
  std::optional<ScrewCandidate> best;
  for (const PedicleScrew& screw : screws_) {
    const double radius_mm = screw.radius_mm();
    if (screw.diameter_mm > kThickestMm || canal_mm < radius_mm + attempt.margin_mm) continue;
    const double tip_at_mm = entry_at_mm + screw.length_mm;
    const Vec3 tip_mm = crossing_mm + tip_at_mm * direction;
    const Vec3 own_mm = marks.to_own(tip_mm);
    if (own_mm.y() < furthest_y_mm || own_mm.y() > back_of_body_mm - 5.0 || side_ * own_mm.x() < radius_mm) continue;
    // The front of the screw is all in the body.
    constexpr double kInBodyMm = 8.0;
    bool holds = true;
    for (double back_mm = 0.0; back_mm <= kInBodyMm && holds; back_mm += 1.0) {
      holds = bone.lattice_mm(tip_mm - back_mm * direction) < -(radius_mm + attempt.margin_mm);
    }
    for (double ahead_mm = 0.0; ahead_mm <= options_.front_margin_mm && holds; ahead_mm += 1.0) {
      holds = bone.lattice_mm(tip_mm + ahead_mm * direction) < 0.0;
    }
    if (!holds || !is_open_behind(bone, entry_mm, direction, radius_mm)) continue;
    // Of the whole screw the share that bone holds, and none of the rim out on any side but the lateral one.
    const std::array<Vec3, 8> rim_mm = rim_of(direction, radius_mm);
    const Vec3 lateral = side_ * marks.left();
    int in = 0, all = 0;
    double out_mm = 0.0;
    for (double at_mm = opening_limit_mm(radius_mm); at_mm <= screw.length_mm - screw.tip_length_mm && holds;
         at_mm += 1.0) {
      const Vec3 p_mm = entry_mm + at_mm * direction;
      for (const Vec3& r : rim_mm) {
        const double value_mm = bone.lattice_mm(p_mm + r);
        ++all;
        in += value_mm < 0.0 ? 1 : 0;
        if (!(value_mm > 0.0)) continue;
        holds = r.dot(lateral) > -0.2 * radius_mm && entry_at_mm + at_mm < kPedicleMm + 4.0;
        out_mm = std::max(out_mm, value_mm);
        if (!holds) break;
      }
    }
    if (!holds || out_mm > options_.lateral_breach_mm) continue;
    ScrewCandidate found{
        trajectory,
        {side_ > 0.0 ? "left" : "right", entry_mm, entry_mm + screw.length_mm * direction, options_.bit, screw},
        0.0};
    found.score = 5.0 * in / std::max(all, 1) - out_mm + share(screw.diameter_mm, kThickestMm) +
                  share(back_of_body_mm - own_mm.y(), options_.furthest_share * marks.body.depth_mm);
    if (!best || found.score > best->score) best = found;
  }
  return best;
}

/// 1: nothing is cut behind the entry, and bone meets the tool flat; 0: 2 mm are cut, or the surface slants by 45
/// degrees.
double TrajectorySearch::approach(const DrillPath& path) const {
  constexpr double kDeepMm = 2.0, kSlantsDeg = 45.0, kReachMm = 30.0;
  const BoneShape& bone = walls_.bone();
  const Vec3 direction = path.direction();
  const double radius_mm = path.screw->radius_mm();
  double cut_mm = 0.0;
  for (const double radius_share : {0.75, 1.0}) {
    const std::array<Vec3, 8> rim_mm = rim_of(direction, radius_share * radius_mm);
    for (double way_mm = opening_limit_mm(radius_mm); way_mm <= kReachMm && cut_mm == 0.0; way_mm += 1.0) {
      const Vec3 p_mm = path.entry_mm - way_mm * direction;
      if (std::any_of(rim_mm.begin(), rim_mm.end(), [&](const Vec3& r) { return bone.lattice_mm(p_mm + r) < 0.0; })) {
        cut_mm = (1.0 - radius_share) * radius_mm + 0.25 * radius_mm;
      }
    }
  }
  const double turned_deg = slant_deg(bone, path.entry_mm, direction);
  return (1.0 - share(cut_mm, kDeepMm)) * (1.0 - 0.5 * share(turned_deg * turned_deg, kSlantsDeg * kSlantsDeg));
}

double TrajectorySearch::score(const DrillPath& path, double pedicle_depth_mm, const Attempt& attempt) const {
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

  // A cortical path has another way to go than the pedicle's axis.
  const bool is_cortical = attempt.technique == Technique::cortical;
  const double turned_deg = is_cortical ? 0.0 : std::acos(std::clamp(direction.dot(reference_), -1.0, 1.0)) / kDegree;
  return weights.length * share(in_body_mm, options_.furthest_share * body.depth_mm) +
         weights.diameter * share(path.screw->diameter_mm, attempt.widest_share * pedicle_.width_mm) +
         weights.clearance * share(pedicle_depth_mm, half_width_mm) +
         weights.canal * share(canal_mm, enough_to_canal_mm) +
         weights.endplates * share(endplate_mm, kEnoughToEndplateMm) +
         weights.density * share(sum_hu / static_cast<double>(hu.size()), kDenseHu) +
         weights.along_axis * (1.0 - share(turned_deg * turned_deg, kTurnedDeg * kTurnedDeg)) +
         (weights.approach > 0.0 ? weights.approach * approach(path) : 0.0);
}

ScrewCandidate TrajectorySearch::refined(ScrewCandidate best, const Attempt& attempt, const PedicleScrew* largest,
                                         std::size_t& looked_at) const {
  constexpr int kHalvings = 4;
  Trajectory step{0.5, 0.75, 2.0, 2.0};
  const double rise_deg = attempt.technique == Technique::cortical ? 90.0 : options_.max_turn_deg;
  for (int halving = 0; halving < kHalvings; ++halving) {
    for (bool goes_on = true; goes_on;) {
      goes_on = false;
      for (double Trajectory::*of :
           {&Trajectory::across_mm, &Trajectory::up_mm, &Trajectory::turn_deg, &Trajectory::rise_deg}) {
        for (const double sign : {-1.0, 1.0}) {
          Trajectory trajectory = best.trajectory;
          trajectory.*of += sign * step.*of;
          if (std::abs(trajectory.turn_deg) > std::max(options_.max_turn_deg, std::abs(best.trajectory.turn_deg)) ||
              std::abs(trajectory.rise_deg - reference_rise_deg_) > rise_deg) {
            continue;
          }
          ++looked_at;
          const std::optional<ScrewCandidate> other = with_screw(trajectory, attempt, largest);
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

SearchLimits TrajectorySearch::limits(const Attempt& attempt, double diameter_mm) const {
  SearchLimits result;
  result.diameter_mm = diameter_mm;
  const std::vector<Trajectory> trajectories = lattice(attempt);
  result.tried = trajectories.size();
  Attempt only = attempt;
  only.least_diameter_mm = diameter_mm;
  const PedicleScrew largest{"", diameter_mm, std::numeric_limits<double>::infinity(), 0.0};
  std::vector<ScrewLimit> found(trajectories.size(), ScrewLimit::none);
  tbb::parallel_for(std::size_t{0}, trajectories.size(),
                    [&](std::size_t n) { with_screw(trajectories[n], only, &largest, &found[n]); });
  for (const ScrewLimit limit : found) ++result.trajectories[static_cast<std::size_t>(limit)];
  return result;
}

std::optional<ScrewCandidate> TrajectorySearch::with_smaller(const ScrewCandidate& found, const Attempt& attempt,
                                                             const PedicleScrew& largest) {
  ++looked_at_;
  const std::optional<ScrewCandidate> smaller = with_screw(found.trajectory, attempt, &largest);
  if (!smaller) return std::nullopt;
  return refined(*smaller, attempt, &largest, looked_at_);
}

std::vector<Trajectory> TrajectorySearch::lattice(const Attempt& attempt) const {
  constexpr int kAcross = 3;  // to each side
  constexpr int kUp = 4;
  constexpr double kTurnStepDeg = 4.0;
  const double outward = side_;  // of width_axis, which points to the patient's left
  std::vector<Trajectory> trajectories;
  if (attempt.technique == Technique::in_out_in) {
    for (double out_mm = 0.0; out_mm <= 0.5 * pedicle_.width_mm + 4.0; out_mm += 0.5) {
      for (int up = -2; up <= 2; ++up) {
        for (double turn_deg = 0.0; turn_deg <= 32.0; turn_deg += kTurnStepDeg) {
          for (double rise_deg = -16.0; rise_deg <= 16.0; rise_deg += kTurnStepDeg) {
            trajectories.push_back({outward * out_mm, 0.1 * pedicle_.height_mm * up, -outward * turn_deg, rise_deg});
          }
        }
      }
    }
    return trajectories;
  }
  const auto over_isthmus = [&](double low_turn_deg, double high_turn_deg, double low_rise_deg, double high_rise_deg) {
    for (int across = -kAcross; across <= kAcross; ++across) {
      for (int up = -kUp; up <= kUp; ++up) {
        const double x = static_cast<double>(across) / kAcross;
        const double y = static_cast<double>(up) / kUp;
        if (x * x + y * y > 1.0) continue;
        for (double turn_deg = low_turn_deg; turn_deg <= high_turn_deg; turn_deg += kTurnStepDeg) {
          for (double rise_deg = low_rise_deg; rise_deg <= high_rise_deg; rise_deg += kTurnStepDeg) {
            trajectories.push_back({0.3 * pedicle_.width_mm * x, 0.35 * pedicle_.height_mm * y, turn_deg, rise_deg});
          }
        }
      }
    }
  };
  if (attempt.technique == Technique::cortical) {
    // Outwards by about 10 and upwards by about 25 degrees of the vertebra's own planes.
    const PathAngles axis = path_angles(pedicle_.axis, walls_.landmarks().axes, side_ > 0.0);
    const double turn_deg = outward * (axis.convergence_deg + 10.0);
    const double rise_deg = 25.0 - axis.inclination_deg;
    over_isthmus(turn_deg - 8.0, turn_deg + 8.0, rise_deg - 8.0, rise_deg + 8.0);
    return trajectories;
  }
  const double max_deg = kTurnStepDeg * static_cast<int>(options_.max_turn_deg / kTurnStepDeg);
  over_isthmus(-max_deg, max_deg, reference_rise_deg_ - max_deg, reference_rise_deg_ + max_deg);
  return trajectories;
}

std::vector<ScrewCandidate> TrajectorySearch::find(const Attempt& attempt, std::size_t max, const Progress& progress) {
  const std::vector<Trajectory> trajectories = lattice(attempt);
  const bool is_beside = attempt.technique == Technique::in_out_in;
  looked_at_ += trajectories.size();
  std::vector<std::optional<ScrewCandidate>> found(trajectories.size());
  ProgressCounter counter(progress, "looking for paths", trajectories.size());
  tbb::parallel_for(std::size_t{0}, trajectories.size(), [&](std::size_t n) {
    found[n] = is_beside ? beside_pedicle(trajectories[n], attempt) : with_screw(trajectories[n], attempt, nullptr);
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
  if (is_beside) return chosen;
  std::vector<std::size_t> looked_at(chosen.size(), 0);
  tbb::parallel_for(std::size_t{0}, chosen.size(),
                    [&](std::size_t n) { chosen[n] = refined(chosen[n], attempt, nullptr, looked_at[n]); });
  for (const std::size_t count : looked_at) looked_at_ += count;
  std::sort(chosen.begin(), chosen.end(), is_better);
  return chosen;
}

}  // namespace spinaltap::detail
