#include "core/session/device/coupled_operator.h"

#include <Eigen/Geometry>

#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

Mat3 frame_of(const Pose& pose, const Vec3& side) {
  Mat3 frame;
  frame << side, pose.axis.cross(side), pose.axis;
  return frame;
}

Vec3 side_of(const Pose& pose) {
  const Vec3 across = pose.side - pose.side.dot(pose.axis) * pose.axis;
  return across.norm() > 1e-6 ? Vec3(across.normalized()) : any_perpendicular(pose.axis);
}

/// With a unit axis, where a device's numbers make sense: within 10 m.
std::optional<Pose> sound_device_pose(Pose pose) {
  constexpr double kFurthestMm = 1e4;
  constexpr double kLoose = 0.01;  // more than floats round
  const double length = pose.axis.norm();
  if (!(pose.tip_mm.cwiseAbs().maxCoeff() < kFurthestMm) || !(std::abs(length - 1.0) < kLoose)) return std::nullopt;
  pose.axis /= length;
  if (!(pose.side.cwiseAbs().maxCoeff() < 1.0 + kLoose)) return std::nullopt;
  if (pose.side != Vec3::Zero()) pose.side = side_of(pose);
  return pose;
}

void check_coupled_options(const CoupledOptions& options) {
  if (!(options.lead_in_mm >= 0.0 && options.lead_in_mm <= 200.0)) {
    fail("coupled operator: expected a lead-in of 0 to 200 mm, found ", options.lead_in_mm);
  }
  if (!(options.longest_s > 0.0)) fail("coupled operator: expected a longest time above 0, found ", options.longest_s);
  if (!(options.gives_up_s > 0.0)) {
    fail("coupled operator: expected a time to give up after above 0, found ", options.gives_up_s);
  }
  if (options.end_button > 32) {
    fail("coupled operator: expected a button to end with from 0 to 31, or 32, found ", options.end_button);
  }
  if (options.mount && !(options.mount->place_mm.allFinite() &&
                         (options.mount->turn * options.mount->turn.transpose() - Mat3::Identity()).norm() < 1e-6 &&
                         options.mount->turn.determinant() > 0.0)) {
    fail("coupled operator: expected a device's mount that is a turn and a finite place");
  }
}

}  // namespace

DeviceMount DeviceMount::between(const Pose& device, const Pose& patient) {
  DeviceMount mount;
  if (device.side != Vec3::Zero() && patient.side != Vec3::Zero()) {
    mount.turn = frame_of(patient, side_of(patient)) * frame_of(device, side_of(device)).transpose();
  } else {
    mount.turn = Eigen::Quaterniond::FromTwoVectors(device.axis, patient.axis).toRotationMatrix();
  }
  mount.place_mm = patient.tip_mm - mount.turn * device.tip_mm;
  return mount;
}

Pose DeviceMount::to_patient(const Pose& device) const {
  return {turn * device.tip_mm + place_mm, (turn * device.axis).normalized(), turn * device.side};
}

Vec3 DeviceMount::to_device(const Vec3& patient) const { return turn.transpose() * patient; }

CoupledOperator::CoupledOperator(HapticDevice& device, const DrillPath& path, const CoupledOptions& options)
    : device_(device),
      path_(path),
      options_(options),
      dt_s_(1.0 / device.limits().rate_hz),
      mount_(options.mount),
      last_sample_s_(-std::numeric_limits<double>::infinity()) {
  check_path(path);
  check_coupled_options(options);
  coupling_gains(device.limits(), options.coupling);
}

CoupledOperator::~CoupledOperator() { device_.give(Vec3::Zero(), Vec3::Zero()); }

/// The device's pose in the device's coordinates, where there is a new one that makes sense.
std::optional<Pose> CoupledOperator::hear() noexcept {
  DeviceSample sample;
  if (!device_.read(sample) || sample.time_s == last_sample_s_) return std::nullopt;
  last_sample_s_ = sample.time_s;
  buttons_ = sample.buttons;
  std::optional<Pose> pose = sound_device_pose(sample.pose);
  if (!pose) ++rejected_poses_;
  return pose;
}

void CoupledOperator::begin() {
  constexpr int kWaitMs = 2000;
  std::optional<Pose> first;
  for (int waited_ms = 0; !(first = hear()); ++waited_ms) {
    if (waited_ms >= kWaitMs) {
      fail("device ", in_quotes(device_.name()), ": expected a pose within ", kWaitMs / 1000, " s, found none",
           rejected_poses_ > 0 ? " that is a place within 10 m and a unit axis" : "");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (!mount_) {
    const PathCurve curve(path_);
    Pose from = curve.pose_at(-options_.lead_in_mm);
    if (from.side == Vec3::Zero()) from.side = any_perpendicular(from.axis);
    mount_ = DeviceMount::between(*first, from);
  }
  coupling_.emplace(device_.limits(), options_.coupling, options_.spindle, mount_->to_patient(*first));
}

std::optional<ToolInput> CoupledOperator::next(const ToolFeedback& feedback) {
  DeviceNews news;
  if (!coupling_) {
    begin();
  } else if (const std::optional<Pose> pose = hear()) {
    news.pose = mount_->to_patient(*pose);
  } else {
    ++silent_cycles_;
  }
  if (cycles_ == 0) news.pose = coupling_->first();
  const bool is_pressed = options_.end_button < 32 && ((buttons_ >> options_.end_button) & 1U) != 0;
  if (is_pressed) return std::nullopt;
  if (static_cast<double>(cycles_) * dt_s_ > options_.longest_s) {
    end_ = OperatorEnd::ran_out_of_time;
    return std::nullopt;
  }
  ++cycles_;
  news.buttons = buttons_;
  const ToolInput input = coupling_->step(news, feedback, dt_s_);
  lost_s_ = input.device.status == DeviceStatus::lost ? lost_s_ + dt_s_ : 0.0;
  if (lost_s_ > options_.gives_up_s) {
    end_ = OperatorEnd::device_lost;
    return std::nullopt;
  }
  device_.give(mount_->to_device(input.device.force_n), mount_->to_device(input.device.torque_n_mm));
  return input;
}

}  // namespace spinaltap
