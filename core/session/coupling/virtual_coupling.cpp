#include "core/session/coupling/virtual_coupling.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace spinaltap {
namespace {

/// The turn that leads from one orientation to another, axis times angle.
Vec3 turn_between(const Mat3& from, const Mat3& to) {
  const Eigen::AngleAxisd turn(Mat3(to * from.transpose()));
  return turn.angle() * turn.axis();
}

Mat3 turned_by(const Vec3& turn, const Mat3& what) {
  const double angle = turn.norm();
  if (!(angle > 0.0)) return what;
  const Mat3 now = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * what;
  // Rounding does not add up.
  const Vec3 axis = now.col(2).normalized();
  Vec3 side = now.col(0);
  side = (side - side.dot(axis) * axis).normalized();
  Mat3 clean;
  clean << side, axis.cross(side), axis;
  return clean;
}

/// The shortest turn of an orientation that brings its axis to `axis`, or that with the side a pose says.
Mat3 turned_to(const Pose& pose, const Mat3& from) {
  Vec3 side = pose.side;
  if (side == Vec3::Zero()) {
    side = Eigen::Quaterniond::FromTwoVectors(Vec3(from.col(2)), pose.axis) * Vec3(from.col(0));
  }
  side = side - side.dot(pose.axis) * pose.axis;
  if (!(side.norm() > 1e-9)) side = any_perpendicular(pose.axis);
  side.normalize();
  Mat3 turned;
  turned << side, pose.axis.cross(side), pose.axis;
  return turned;
}

Mat3 first_turned(const Pose& pose) {
  Mat3 along;
  const Vec3 side = any_perpendicular(pose.axis);
  along << side, pose.axis.cross(side), pose.axis;
  return turned_to(pose, along);
}

Vec3 no_longer_than(const Vec3& vector, double longest) {
  const double length = vector.norm();
  return length > longest ? Vec3(vector * (longest / length)) : vector;
}

Vec3 towards(const Vec3& from, const Vec3& to, double furthest) { return from + no_longer_than(to - from, furthest); }

bool is_touched(const DrillForce& bone) {
  const auto& stiffness = bone.contact.stiffness;
  return bone.resistance.lips_n > 0.0 || bone.resistance.chisel_n > 0.0 || bone.force_n != Vec3::Zero() ||
         std::any_of(stiffness.begin(), stiffness.end(), [](double of) { return of != 0.0; });
}

/// Feed at which the tool is in balance with the thrust, mm/s. `free_mm_s`: without any; each N of thrust takes
/// `slows_mm_s` off.
double feed_against(const CuttingResistance& bone, double turns_per_s, double free_mm_s, double slows_mm_s) {
  if (!(free_mm_s > 0.0)) return free_mm_s;
  if (!(free_mm_s > slows_mm_s * bone.chisel_n)) return 0.0;
  if (!(bone.lips_n > 0.0)) return free_mm_s - slows_mm_s * bone.chisel_n;
  // The thrust rises with the feed: halving finds the one feed that fits, the same on every machine.
  constexpr int kHalvings = 40;
  double low_mm_s = 0.0, high_mm_s = free_mm_s;
  for (int halving = 0; halving < kHalvings; ++halving) {
    const double middle_mm_s = 0.5 * (low_mm_s + high_mm_s);
    const bool is_slower = middle_mm_s + slows_mm_s * bone.thrust_n(middle_mm_s / turns_per_s) < free_mm_s;
    (is_slower ? low_mm_s : high_mm_s) = middle_mm_s;
  }
  return 0.5 * (low_mm_s + high_mm_s);
}

}  // namespace

struct VirtualCoupling::Balance {
  Mat6 matrix = Mat6::Zero();
  Vec6 push = Vec6::Zero();

  void add(int first, double diagonal, const Vec3& pushes) {
    for (int n = 0; n < 3; ++n) matrix(first + n, first + n) += diagonal;
    push.segment<3>(first) += pushes;
  }
};

VirtualCoupling::VirtualCoupling(const DeviceLimits& limits, const CouplingOptions& options, const Spindle& spindle,
                                 const Pose& first)
    : first_(first),
      limits_(limits),
      options_(options),
      spindle_(spindle),
      gains_(coupling_gains(limits, options)),
      energy_(limits, gains_, 1.0 / limits.rate_hz),
      device_turned_(first_turned(first)),
      tip_mm_(first.tip_mm),
      turned_(device_turned_) {
  device_.status = DeviceStatus::live;
  device_.pose = first;
}

Twist VirtualCoupling::stretch() const noexcept {
  Twist stretch{device_.pose.tip_mm - tip_mm_, Vec3::Zero()};
  if (limits_.senses_turn) stretch.turn = turn_between(turned_, device_turned_);
  return stretch;
}

void VirtualCoupling::take_pose(const Pose& pose) noexcept {
  const Mat3 turned = limits_.senses_turn ? turned_to(pose, device_turned_) : device_turned_;
  const Twist way{pose.tip_mm - device_.pose.tip_mm,
                  limits_.senses_turn ? turn_between(device_turned_, turned) : Vec3::Zero()};
  energy_.moved(way);
  device_rate_ = {way.way / silent_s_, way.turn / silent_s_};
  device_.pose = pose;
  device_turned_ = turned;
}

void VirtualCoupling::hear(const DeviceNews& news, double dt_s) noexcept {
  silent_s_ += dt_s;
  if (news.pose) {
    device_.buttons = news.buttons;
    device_.status = DeviceStatus::live;
    take_pose(*news.pose);
    silent_s_ = 0.0;
  } else {
    // Half a cycle forgives the rounding of sums of cycles.
    const bool is_lost = device_.status == DeviceStatus::lost || silent_s_ > options_.lost_s - 0.5 * dt_s;
    device_.status = is_lost ? DeviceStatus::lost : DeviceStatus::silent;
    device_rate_ = {};
  }
  const bool is_lost = device_.status == DeviceStatus::lost;
  hold_ = std::clamp(hold_ + (is_lost ? -dt_s / options_.fade_s : dt_s / options_.return_s), 0.0, 1.0);
}

/// Springs and dampers of what bone does to the tool, as they will be at the cycle's end.
void VirtualCoupling::add_bone(const ToolFeedback& felt, bool spindle_on, double dt_s,
                               Balance& balance) const noexcept {
  constexpr double kSlowestMmS = 0.1;
  const DrillForce& bone = felt.force;
  const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> stiffness(bone.contact.stiffness.data());
  balance.matrix += dt_s * stiffness;
  balance.push.head<3>() += spindle_on ? bone.support_n : bone.contact_n;
  balance.push.tail<3>() += bone.contact.moment_n_mm;
  if (!spindle_on) return;
  // Cutting sideways takes energy: against the way it counts as a damper, which cannot push. What lies across the way
  // does no work.
  const Vec3 axis = this->axis();
  const auto across = [&](const Vec3& of) { return Vec3(of - of.dot(axis) * axis); };
  const Vec3 cut_n = across(bone.lateral_n), goes_mm_s = across(rate_.way);
  const double mm_s = goes_mm_s.norm();
  const Vec3 along = mm_s > 0.0 ? Vec3(goes_mm_s / mm_s) : Vec3::Zero();
  const double against_n = std::max(0.0, -cut_n.dot(along));
  const double damping = std::max(against_n, cut_n.norm() * (mm_s > 0.0 ? 0.0 : 1.0)) / std::max(mm_s, kSlowestMmS);
  balance.matrix.topLeftCorner<3, 3>() += damping * (Mat3::Identity() - axis * axis.transpose());
  balance.push.head<3>() += no_longer_than(cut_n - cut_n.dot(along) * along, against_n);
}

void VirtualCoupling::move(const ToolFeedback& felt, bool spindle_on, double dt_s) noexcept {
  constexpr double kStiffensS = 0.02, kSoftensS = 0.2;
  stiff_ = is_touched(felt.force) ? std::min(1.0, stiff_ + dt_s / kStiffensS)
                                  : std::max(kStiffInAir, stiff_ - dt_s / kSoftensS);
  const double scale = options_.force_scale;
  const Twist stretched = stretch();
  Balance free;
  const auto add_tool = [&](int first, const CouplingGain& gain, const Vec3& rate) {
    free.add(first, gain.mass / (scale * dt_s) + gain.tool_damping / scale, gain.mass / (scale * dt_s) * rate);
  };
  add_tool(0, gains_.way, rate_.way);
  add_tool(3, gains_.turn, rate_.turn);
  add_bone(felt, spindle_on, dt_s, free);

  const bool turns = limits_.senses_turn;
  const double turns_per_s = spindle_.rpm / 60.0;
  const CuttingResistance resistance = spindle_on ? felt.force.resistance : CuttingResistance{};
  const double most_n = hold_ * limits_.max_force_n / scale;
  const double most_n_mm = hold_ * (limits_.gives_torque ? limits_.max_torque_n_mm / scale : 1e9);
  const Vec3 axis = this->axis();
  if (turns && limits_.gives_torque && spindle_on) {
    const double feed_mm = std::max(0.0, rate_.way.dot(axis)) / turns_per_s;
    free.push.tail<3>() -= (spindle_.is_clockwise ? 1.0 : -1.0) * resistance.torque_n_mm(feed_mm) * axis;
  }

  // A spring that would pull harder than the device can show pulls with that.
  bool is_full[2] = {false, false};
  for (int round = 0; round < 3; ++round) {
    Balance balance = free;
    const auto add_pull = [&](int first, const CouplingGain& gain, const Vec3& stretch, const Vec3& device, bool full,
                              const Vec3& pull) {
      if (full) {
        balance.push.segment<3>(first) += pull;
        return;
      }
      const double share = hold_ * stiff_ / scale;
      balance.add(first, share * (gain.stiffness * dt_s + gain.damping),
                  share * (gain.stiffness * stretch + gain.damping * device));
    };
    add_pull(0, gains_.way, stretched.way, device_rate_.way, is_full[0], pull_.force_n);
    add_pull(3, gains_.turn, stretched.turn, device_rate_.turn, is_full[1], pull_.torque_n_mm);
    if (!turns) {
      balance.matrix.bottomRows<3>().setZero();
      balance.matrix.rightCols<3>().setZero();
      balance.matrix.bottomRightCorner<3, 3>().setIdentity();
      balance.push.tail<3>().setZero();
    }
    const Eigen::LLT<Mat6> solved(balance.matrix);
    Vec6 rate = solved.solve(balance.push);
    if (spindle_on && (resistance.lips_n > 0.0 || resistance.chisel_n > 0.0)) {
      Vec6 thrust = Vec6::Zero();
      thrust.head<3>() = axis;
      const Vec6 slows = solved.solve(thrust);
      const double free_mm_s = rate.head<3>().dot(axis), slows_mm_s = slows.head<3>().dot(axis);
      const double feed_mm_s = feed_against(resistance, turns_per_s, free_mm_s, slows_mm_s);
      rate -= (free_mm_s - feed_mm_s) / slows_mm_s * slows;
    }
    rate_ = {rate.head<3>(), rate.tail<3>()};
    const double share = hold_ * stiff_ / scale;
    const auto pull_of = [&](const CouplingGain& gain, const Vec3& stretch, const Vec3& device, const Vec3& tool) {
      return Vec3(share * (gain.stiffness * (stretch - dt_s * tool) + gain.damping * (device - tool)));
    };
    bool is_done = true;
    if (!is_full[0]) {
      pull_.force_n = pull_of(gains_.way, stretched.way, device_rate_.way, rate_.way);
      if (pull_.force_n.norm() > most_n) {
        pull_.force_n = no_longer_than(pull_.force_n, most_n);
        is_full[0] = true;
        is_done = false;
      }
    }
    if (turns && !is_full[1]) {
      pull_.torque_n_mm = pull_of(gains_.turn, stretched.turn, device_rate_.turn, rate_.turn);
      if (pull_.torque_n_mm.norm() > most_n_mm) {
        pull_.torque_n_mm = no_longer_than(pull_.torque_n_mm, most_n_mm);
        is_full[1] = true;
        is_done = false;
      }
    }
    if (is_done) break;
  }
  tip_mm_ += dt_s * rate_.way;
  if (turns) turned_ = turned_by(dt_s * rate_.turn, turned_);
}

/// Tells the device what to give, within all bounds.
void VirtualCoupling::give(double dt_s) noexcept {
  Wrench wanted;
  wanted.force_n = -options_.force_scale * pull_.force_n;
  if (limits_.gives_torque) wanted.torque_n_mm = -options_.force_scale * pull_.torque_n_mm;
  wanted = energy_.allowed(wanted, device_rate_);
  wanted.force_n = no_longer_than(wanted.force_n, hold_ * limits_.max_force_n);
  wanted.torque_n_mm = no_longer_than(wanted.torque_n_mm, hold_ * limits_.max_torque_n_mm);
  const double change = dt_s / options_.whole_change_s;
  given_.force_n = towards(given_.force_n, wanted.force_n, change * limits_.max_force_n);
  given_.torque_n_mm = towards(given_.torque_n_mm, wanted.torque_n_mm, change * limits_.max_torque_n_mm);
  energy_.given(given_, dt_s);
}

ToolInput VirtualCoupling::step(const DeviceNews& news, const ToolFeedback& felt, double dt_s) noexcept {
  hear(news, dt_s);
  const bool is_lost = device_.status == DeviceStatus::lost;
  const unsigned button = options_.spindle_button;
  const bool is_pressed = button > 31 || ((device_.buttons >> button) & 1U) != 0;
  const bool spindle_on = is_pressed && !(hold_ < 1.0) && !felt.stop && spindle_.rpm > 0.0;
  if (is_lost) {
    // The tool stands; what was given fades.
    rate_ = {};
    const double before = std::min(1.0, hold_ + dt_s / options_.fade_s);
    const double share = before > 0.0 ? hold_ / before : 0.0;
    pull_.force_n *= share;
    pull_.torque_n_mm *= share;
  } else {
    // Bone resists as it did last: with contact in the cycle in which the spindle starts.
    move(felt, was_on_, dt_s);
  }
  was_on_ = spindle_on;
  give(dt_s);
  ToolInput input;
  input.pose = {tip_mm_, axis(), turned_.col(0)};
  input.spindle_on = spindle_on;
  input.dt_s = dt_s;
  device_.force_n = given_.force_n;
  device_.torque_n_mm = given_.torque_n_mm;
  input.device = device_;
  return input;
}

}  // namespace spinaltap
