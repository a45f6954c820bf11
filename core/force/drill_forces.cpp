// Forces from the energy of what was cut; docs/forces.md derives them.
//
// Energy is shared out between two ways of the tip: along the bit's axis into fresh bone, and across it. What the
// section times the uncut advance holds goes to the first, the rest to the second. An operator's tremor, which goes
// across faster than the feed, thus neither thins nor swells the thrust.

#include "core/force/drill_forces.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/force/detail/contact_stiffness_sum.h"
#include "core/force/detail/hole_behind.h"
#include "core/force/detail/lattice_section.h"
#include "core/force/detail/tool_contact.h"
#include "core/force/detail/wall_support.h"
#include "core/force/detail/way_average.h"
#include "core/force/force_band.h"
#include "core/points/bone_points.h"

namespace spinaltap {
namespace {

constexpr double kWholeTurn = 2.0 * std::numbers::pi;
/// Of the tip's speed. Short of what an operator feels as delay, longer than a device's noise from pose to pose.
constexpr double kSpeedFilterS = 0.005;
/// The shortest boxes of averaging, mm.
constexpr double kMinBoxMm = 0.2;
/// Below this feed per stroke a driven edge does not take all of its force: at rest it takes none.
constexpr double kEdgeFeedMm = 1e-3;
/// A bit that went back feels nothing until it is so near its deepest place again.
constexpr double kFreshMm = 0.02;

/// How far aside a tool that went back is at another place of the bone.
double hole_radius_mm(const DrillBit& bit) { return bit.is_plate() ? 0.5 * bit.thickness_mm : bit.radius_mm(); }

/// Of contact: bone resists more what goes into it, and gives less back (Hunt & Crossley 1975: 1.5 (1 - e) / v, e being
/// a half at half a metre a second).
double damping_factor(const Vec3& contact_n, const Vec3& velocity_mm_s) {
  constexpr double kDampingSMm = 0.0015;
  const double push_n = contact_n.norm();
  if (!(push_n > 0.0)) return 1.0;
  return std::max(0.0, 1.0 - kDampingSMm * velocity_mm_s.dot(contact_n) / push_n);
}

/// How a tool goes across its axis, over a step or in a second: its tip, and by its turn the more the further back.
struct AcrossWay {
  Vec3 tip_mm;
  Vec3 turn;         ///< change of the axis
  double radius_mm;  ///< turning moves what lies beside the axis along it as well: its wall by half of this squared

  AcrossWay(const Vec3& move_mm, const Vec3& turned, const Vec3& axis, double wall_mm)
      : tip_mm(move_mm - move_mm.dot(axis) * axis), turn(turned - turned.dot(axis) * axis), radius_mm(wall_mm) {}
  Vec3 at_mm(double back_mm) const { return tip_mm - back_mm * turn; }
  /// Mean square over places with that mean and that mean square of how far back they lie.
  double square_mm2(double back_mm, double back_mm2) const {
    const double aside = tip_mm.squaredNorm() - 2.0 * back_mm * tip_mm.dot(turn);
    return std::max(0.0, aside + (back_mm2 + 0.5 * radius_mm * radius_mm) * turn.squaredNorm());
  }
};

/// Where a step cut, back from the tip, and how much dearer than at one feed for all.
struct CutPlaces {
  double back_mm = 0.0, back_mm2 = 0.0;  ///< means over the energy
  double dearer = 1.0;
};

/// By AcrossWay of the step each part of the bit's length has a feed of its own, and thin chips cost more.
CutPlaces cut_places(const StepResult& result, const AcrossWay& way, const Vec3& axis, double length_mm,
                     double feed_exponent) {
  CutPlaces places;
  if (!(result.work_n_mm > 0.0)) return places;
  places.back_mm = -result.moment_n_mm2.dot(axis) / result.work_n_mm;
  places.back_mm2 = places.back_mm * places.back_mm;
  double work = 0.0, middle_mm = 0.0;
  const auto& parts = result.work_back_n_mm;
  const double part_mm = length_mm / static_cast<double>(parts.size());
  for (std::size_t n = 0; n < parts.size(); ++n) {
    work += parts[n];
    middle_mm += parts[n] * (static_cast<double>(n) + 0.5) * part_mm;
  }
  if (!(work > 0.0)) return places;
  // Bone does not lie in the middles of the parts: their mean is known better.
  const double shift_mm = places.back_mm - middle_mm / work;
  double square = 0.0, dear = 0.0;
  for (std::size_t n = 0; n < parts.size(); ++n) {
    if (parts[n] == 0.0) continue;
    const double back_mm = (static_cast<double>(n) + 0.5) * part_mm + shift_mm;
    square += parts[n] * back_mm * back_mm;
    dear += parts[n] * std::pow(way.square_mm2(back_mm, back_mm * back_mm), -0.5 * feed_exponent);
  }
  places.back_mm2 = square / work;
  const double mean = way.square_mm2(places.back_mm, places.back_mm2);
  const double dearer = dear / work * std::pow(mean, 0.5 * feed_exponent);
  if (std::isfinite(dearer)) places.dearer = dearer;
  return places;
}

/// A way along an axis, less what only makes up for an earlier retreat.
class UncutAdvance {
 public:
  void reset() noexcept { *this = UncutAdvance(); }
  /// How much of an advance goes into fresh bone. `removed_mm` of advance would have cut what this step did.
  double take(double advance_mm, const Vec3& tip_mm, const Vec3& axis, double radius_mm, double removed_mm) noexcept {
    if (retreat_mm_ > 0.0) {
      // Aside by more than the hole's radius there is another place to drill; and bone that is cut is fresh.
      const Vec3 from_mm = tip_mm - left_mm_;
      if ((from_mm - from_mm.dot(axis) * axis).norm() > radius_mm) retreat_mm_ = 0.0;
      retreat_mm_ = std::max(0.0, retreat_mm_ - removed_mm);
    }
    if (advance_mm <= 0.0) {
      if (retreat_mm_ == 0.0) left_mm_ = tip_mm;
      retreat_mm_ -= advance_mm;
      return 0.0;
    }
    const double fresh_mm = std::max(0.0, advance_mm - retreat_mm_);
    retreat_mm_ = std::max(0.0, retreat_mm_ - advance_mm);
    return fresh_mm;
  }
  double retreat_mm() const { return retreat_mm_; }

 private:
  double retreat_mm_ = 0.0;
  Vec3 left_mm_ = Vec3::Zero();
};

/// What the section of points that a bit cuts lacks to the bit's own, where it stays at one place across the discs.
class LatticeAreaCorrection {
 public:
  void reset() noexcept { *this = LatticeAreaCorrection(); }
  double factor(const OccupiedBone& bone, const Pose& pose, double back_mm, double radius_mm, double way_mm) noexcept {
    const PointVolume* const points = bone.discs_at(pose.tip_mm.z() - back_mm * pose.axis.z());
    if (points == nullptr) return 1.0;
    const double spacing_mm = points->pattern().spacing_mm();
    const Eigen::Vector2d place_mm = pose.tip_mm.head<2>();
    still_mm_ += way_mm;
    if (is_placed_ && !((place_mm - anchor_mm_).norm() <= kStill * spacing_mm)) {
      still_mm_ = 0.0;
      is_placed_ = false;
    }
    if (!is_placed_) {
      is_placed_ = true;
      anchor_mm_ = place_mm;
    }
    // Where it moves, or where points are jittered, sections differ from disc to disc and average out.
    if (still_mm_ < spacing_mm || points->out_of_plane_mm() > 0.0) return 1.0;
    if (points != counted_ || !((place_mm - counted_mm_).norm() <= kSameMm)) {
      counted_mm_ = place_mm;
      counted_ = points;
      factor_ =
          section_over_points(points->pattern(), radius_mm, place_mm.norm(), std::atan2(place_mm.y(), place_mm.x()));
    }
    return factor_;
  }

 private:
  static constexpr double kStill = 0.02;   ///< spacings
  static constexpr double kSameMm = 1e-9;  ///< poses in patient coordinates round by 1e-13

  bool is_placed_ = false;
  double still_mm_ = 1e9;  ///< way since the anchor was left
  Eigen::Vector2d anchor_mm_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d counted_mm_ = Eigen::Vector2d::Constant(1e9);
  const PointVolume* counted_ = nullptr;
  double factor_ = 1.0;
};

}  // namespace

struct DrillForces::State {
  State(std::unique_ptr<const OccupiedBone> own_bone, const DrillBit& drill_bit, const Material& drilled)
      : State(*own_bone, drill_bit, drilled) {
    own = std::move(own_bone);
  }
  State(const OccupiedBone& occupied, const DrillBit& drill_bit, const Material& drilled)
      : bit(drill_bit),
        law(drill_bit, drilled),
        band(drilled),
        feed_exponent(drilled.feed_exponent),
        bone(occupied),
        tip(probe_of(bone, drill_bit, law)),
        shell(bone, drill_bit),
        wall(bone, drill_bit),
        boxes(std::max(1.0, std::ceil(kMinBoxMm / bone.widest_spacing_mm() - 1e-9))),
        axial(boxes * bone.widest_spacing_mm(), bins_of(boxes)),
        across(boxes * bone.widest_spacing_mm(), bins_of(boxes)) {}

  /// A plate's walls lie on both sides of its middle, half its thickness off.
  double wall_mm() const noexcept { return bit.is_plate() ? 0.5 * bit.thickness_mm : bit.radius_mm(); }

  static ChiselProbe probe_of(const OccupiedBone& bone, const DrillBit& bit, const ToolLaw& law) {
    return bit.is_plate() ? ChiselProbe::of_edge(bone, bit.diameter_mm) : ChiselProbe(bone, law.chisel_radius_mm());
  }

  /// So few that a cycle is short, so many that a disc's points, which count as spread over a bin, come out even.
  static int bins_of(double boxes) { return std::max(48, 8 * static_cast<int>(boxes)); }

  void reset() noexcept {
    axial.reset();
    across.reset();
    fresh.reset();
    repair.reset();
    hole.reset();
    wall.reset();
    budget_mm3 = 0.0;
    velocity_mm_s.setZero();
    turn_per_s.setZero();
    is_placed = false;
  }

  void take_step(const StepResult& result, const Pose& path_pose, const Vec3& axis, const Vec3& move_mm,
                 const Vec3& turn) noexcept;
  void cut(const Pose& path_pose, const Vec3& axis, const Spindle& spindle, DrillForce& force) noexcept;

  DrillBit bit;
  ToolLaw law;
  ForceBand band;
  double feed_exponent;
  std::unique_ptr<const OccupiedBone> own;  ///< null: another's
  const OccupiedBone& bone;
  ChiselProbe tip;
  ToolContact shell;
  WallSupport wall;
  double boxes;  ///< spacings in a box
  WayAverage axial, across;
  UncutAdvance fresh;
  LatticeAreaCorrection repair;
  HoleBehind hole;
  double budget_mm3 = 0.0;  ///< what the uncut advance may still cut
  CutPlaces places;         ///< of the last step that cut
  Vec3 velocity_mm_s = Vec3::Zero(), turn_per_s = Vec3::Zero();
  Vec3 tip_mm = Vec3::Zero(), axis_before = Vec3::UnitZ();  ///< patient LPS
  bool is_placed = false;
  bool reports_contact = false;
  bool has_support = true;
};

void DrillForces::State::take_step(const StepResult& result, const Pose& path_pose, const Vec3& axis,
                                   const Vec3& move_mm, const Vec3& turn) noexcept {
  const double area_mm2 = law.section_mm2();
  const double advance_mm = move_mm.dot(axis);
  const AcrossWay way(move_mm, turn, axis, wall_mm());
  if (result.work_n_mm > 0.0) places = cut_places(result, way, axis, bit.length_mm, feed_exponent);
  const double across_mm = std::sqrt(way.square_mm2(places.back_mm, places.back_mm2));
  const double back_mm = 0.5 * bit.head_mm();
  const double factor = repair.factor(bone, path_pose, back_mm, bit.radius_mm(), move_mm.norm());
  const double removed_mm3 = factor * result.removed_mm3;
  const double fresh_mm = fresh.take(advance_mm, tip_mm, axis, hole_radius_mm(bit), removed_mm3 / area_mm2);

  // Discs die in bursts: up to two of them may be cut ahead of the advance that they stand for.
  const double max_mm3 = 2.0 * bone.widest_spacing_mm() * area_mm2;
  budget_mm3 = std::min(budget_mm3 + fresh_mm * area_mm2, max_mm3 + fresh_mm * area_mm2);
  const double axial_mm3 = std::min(removed_mm3, budget_mm3);
  budget_mm3 = std::min(budget_mm3 - axial_mm3, max_mm3);
  const double axial_share = removed_mm3 > 0.0 ? axial_mm3 / removed_mm3 : 0.0;

  WayAverage::Sums sums;
  sums << factor * result.work_n_mm, factor * result.moment_n_mm2, factor * result.work_n_mm * places.back_mm2;
  axial.add(fresh_mm, axial_share * sums);
  hole.take(fresh_mm, axial_share * sums[0], tip_mm, axis, hole_radius_mm(bit));
  across.add(across_mm, (1.0 - axial_share) * places.dearer * sums);
}

void DrillForces::State::cut(const Pose& path_pose, const Vec3& axis, const Spindle& spindle,
                             DrillForce& force) noexcept {
  const double radius_mm = bit.radius_mm();
  const double turns_per_s = spindle.rpm / 60.0;
  const double advance_mm_s = velocity_mm_s.dot(axis);
  const double advance_mm = std::max(0.0, advance_mm_s) / turns_per_s;
  const double fresh_share = std::clamp(1.0 - fresh.retreat_mm() / kFreshMm, 0.0, 1.0);
  const WayAverage::Sums along = fresh_share * axial.per_mm();
  const WayAverage::Sums aside = across.per_mm();
  const AcrossWay way_mm_s(velocity_mm_s, turn_per_s, axis, wall_mm());
  const double back_mm = aside[0] > 0.0 ? -aside.segment<3>(1).dot(axis) / aside[0] : places.back_mm;
  const double back_mm2 = aside[0] > 0.0 ? aside[4] / aside[0] : places.back_mm2;
  const double across_mm_s = std::sqrt(way_mm_s.square_mm2(back_mm, back_mm2));
  const double across_mm = across_mm_s / turns_per_s;
  const OccupiedBone::Mean ahead = tip.ahead_of(path_pose);

  force.tip_density_g_cm3 = ahead.density_g_cm3;
  force.feed_mm_per_turn = std::hypot(advance_mm_s, across_mm_s) / turns_per_s;
  // A sharp tip that went back a little still has bone beside it: that is not pressed either.
  const DrilledDepth behind = hole.behind(tip_mm, axis, law.section_mm2());
  force.resistance = law.resistance({along[0], fresh_share * ahead.chisel_mpa, behind}, spindle.rpm);
  force.thrust_n = force.resistance.thrust_n(advance_mm);
  const double dear = law.energy_factor(spindle.rpm);
  const double along_mm = dear * law.feed_times_factor_mm(advance_mm);
  const double aside_mm = dear * law.feed_times_factor_mm(across_mm);
  if (bit.is_plate()) {
    const Vec3 cut_mm_s = way_mm_s.at_mm(back_mm);
    // Driven aside an edge does not cut: it takes all of the energy from the hand.
    const double aside_n = bit.stroke_mm > 0.0 ? law.lip_thrust_share() * aside[0] * aside_mm / (2.0 * bit.stroke_mm)
                                               : aside[0] * std::clamp(across_mm / kEdgeFeedMm, 0.0, 1.0);
    if (cut_mm_s.norm() > 0.0) force.lateral_n = -aside_n * cut_mm_s.normalized();
    return;
  }
  const double chips = law.chips_factor(behind.depth_mm);
  force.torque_n_mm =
      (chips * along[0] * along_mm + aside[0] * aside_mm) / kWholeTurn + force.resistance.rubbing_n_mm(advance_mm);

  // The force along the cut, from the moment of the energy: exact where the lips cut evenly from the axis to the rim,
  // and where they cut with the rim alone.
  const double rim_mm2 = radius_mm * radius_mm;
  const Vec3 moment = (3.0 * along_mm * along.segment<3>(1) + aside_mm * aside.segment<3>(1)) / (kWholeTurn * rim_mm2);
  const Vec3 side_n = moment - moment.dot(axis) * axis;
  const Vec3 with_turn_n = spindle.is_clockwise ? axis.cross(side_n) : side_n.cross(axis);
  force.lateral_n = -with_turn_n - law.lip_thrust_share() * side_n;
}

DrillForces::DrillForces(const OccupiedBone& bone, const DrillBit& bit, const Material& material)
    : state_(std::make_unique<State>(bone, bit, material)) {}
DrillForces::DrillForces(std::span<const PointVolume> volumes, const DrillBit& bit, const Material& material)
    : state_(std::make_unique<State>(std::make_unique<BonePoints>(volumes, material), bit, material)) {}
DrillForces::~DrillForces() = default;
DrillForces::DrillForces(DrillForces&&) noexcept = default;
DrillForces& DrillForces::operator=(DrillForces&&) noexcept = default;

void DrillForces::reset() noexcept { state_->reset(); }
void DrillForces::report_contact() noexcept { state_->reports_contact = true; }
void DrillForces::leave_out_support() noexcept { state_->has_support = false; }

DrillForce DrillForces::update(const StepResult& result, const Pose& pose, double dt_s,
                               const Spindle& spindle) noexcept {
  State& state = *state_;
  DrillForce force;
  const double axis_length = pose.axis.norm();
  if (!pose.tip_mm.allFinite() || !(std::abs(axis_length - 1.0) < 1e-6) || !(dt_s > 0.0) || !std::isfinite(dt_s)) {
    return force;
  }
  const Vec3 axis = pose.axis / axis_length;
  const Pose path_pose = state.bone.frame().to_path(Pose{pose.tip_mm, axis, pose.side});
  const Vec3 move_mm = state.is_placed ? Vec3(pose.tip_mm - state.tip_mm) : Vec3::Zero();
  // What dies where the bit is first put was not cut on any way.
  const bool was_placed = state.is_placed;
  const Vec3 turn = state.is_placed ? Vec3(axis - state.axis_before) : Vec3::Zero();
  state.is_placed = true;
  state.axis_before = axis;
  state.tip_mm = pose.tip_mm;
  ContactStiffnessSum contact;
  ContactStiffnessSum* const wanted = state.reports_contact ? &contact : nullptr;
  const double newer = dt_s / (kSpeedFilterS + dt_s);
  state.velocity_mm_s += newer * (move_mm / dt_s - state.velocity_mm_s);
  state.turn_per_s += newer * (turn / dt_s - state.turn_per_s);

  if (!(spindle.rpm > 0.0) || !std::isfinite(spindle.rpm)) {
    // What was cut before says nothing of where the bit goes meanwhile.
    state.axial.reset();
    state.across.reset();
    state.fresh.reset();
    state.budget_mm3 = 0.0;
    force.tip_density_g_cm3 = state.tip.ahead_of(path_pose).density_g_cm3;
    state.wall.reset();
    const Vec3 contact_n = state.shell.contact_n(path_pose, wanted);
    force.contact_n = state.bone.frame().to_patient(Pose{Vec3::Zero(), contact_n}).axis;
    const double damping = damping_factor(force.contact_n, state.velocity_mm_s);
    force.contact_n *= damping;
    force.force_n = force.contact_n;
    if (wanted != nullptr) force.contact = contact.in_patient(state.bone.frame(), damping);
    return force;
  }
  if (was_placed) state.take_step(result, path_pose, axis, move_mm, turn);
  state.cut(path_pose, axis, spindle, force);
  force.thrust_band_n = state.band.thrust_n(force.thrust_n);
  force.torque_band_n_mm = state.band.torque_n_mm(force.torque_n_mm);
  if (state.has_support) {
    const auto turned = [&](const Vec3& patient) {
      return state.bone.frame().to_path(Pose{Vec3::Zero(), patient}).axis;
    };
    const Vec3 support_n =
        state.wall.force_n(path_pose, turned(move_mm), turned(turn), spindle.rpm / 60.0 * dt_s, wanted);
    force.support_n = state.bone.frame().to_patient(Pose{Vec3::Zero(), support_n}).axis;
  }
  if (wanted != nullptr) force.contact = contact.in_patient(state.bone.frame());
  force.force_n = force.lateral_n + force.support_n - force.thrust_n * axis;
  return force;
}

}  // namespace spinaltap
