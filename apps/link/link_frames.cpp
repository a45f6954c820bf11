#include "apps/link/link_frames.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {

Vec3 ras_from_lps(const Vec3& lps) { return {-lps.x(), -lps.y(), lps.z()}; }
Vec3 lps_from_ras(const Vec3& ras) { return {-ras.x(), -ras.y(), ras.z()}; }
Eigen::Vector3f ras_from_lps(const Eigen::Vector3f& lps) { return {-lps.x(), -lps.y(), lps.z()}; }

LinkTransform bit_in_ras(const Pose& pose_lps) {
  const Vec3 axis = ras_from_lps(pose_lps.axis).normalized();
  Vec3 side = ras_from_lps(pose_lps.side);
  side -= side.dot(axis) * axis;
  side = side.norm() > 1e-6 ? Vec3(side.normalized()) : any_perpendicular(axis);
  LinkTransform transform = LinkTransform::Identity();
  transform.linear().col(0) = side;
  transform.linear().col(1) = axis.cross(side);
  transform.linear().col(2) = axis;
  transform.translation() = ras_from_lps(pose_lps.tip_mm);
  return transform;
}

LinkTransform patient_in_ras(const RigidPose& ct_from_patient) {
  const Vec3 flips(-1.0, -1.0, 1.0);
  LinkTransform transform = LinkTransform::Identity();
  transform.linear() = flips.asDiagonal() * ct_from_patient.rotation * flips.asDiagonal();
  transform.translation() = ras_from_lps(ct_from_patient.translation_mm);
  return transform;
}

ToolFrame tool_frame(const Vec3& tip_mm, const Vec3& axis) {
  constexpr double kFarthestMm = 1000.0;
  if (!tip_mm.allFinite() || !(tip_mm.norm() <= kFarthestMm)) {
    fail("link: expected a tip within ", kFarthestMm, " mm of the tracked tool's origin, found ", tip_mm.transpose());
  }
  if (!axis.allFinite() || !(axis.norm() > 1e-6)) {
    fail("link: expected a direction as the tool's axis, found ", axis.transpose());
  }
  const Vec3 unit = axis.normalized();
  return {tip_mm, unit, any_perpendicular(unit)};
}

Pose pose_in_lps(const LinkTransform& tool_in_ras, const ToolFrame& frame) {
  // The rotation comes as floats: its columns are unit and at right angles to a millionth or, of trackers, a
  // thousandth.
  const Vec3 axis = lps_from_ras(tool_in_ras.linear() * frame.axis).normalized();
  Vec3 side = lps_from_ras(tool_in_ras.linear() * frame.side);
  side = (side - side.dot(axis) * axis).normalized();
  return {lps_from_ras(tool_in_ras * frame.tip_mm), axis, side};
}

std::string_view name_of(TrackingState state) {
  constexpr std::array<std::string_view, 4> kNames{"waiting", "ok", "stale", "invalid"};
  return kNames.at(static_cast<std::size_t>(state));
}

Tracking::Tracking(const TrackingOptions& options) : options_(options) {
  if (options.registration) update(LinkDevice::patient, patient_in_ras(*options.registration), true, 0);
}

void Tracking::update(LinkDevice device, const LinkTransform& transform, bool is_valid, std::int64_t now_ns) {
  Tracked& tracked = of(device);
  if (is_valid) tracked.transform = transform;
  tracked.is_valid = is_valid;
  tracked.at_ns = now_ns;
  tracked.is_there = true;
}

void Tracking::invalidate(LinkDevice device, std::int64_t now_ns) {
  if (Tracked& tracked = of(device); tracked.is_there) {
    tracked.is_valid = false;
    tracked.at_ns = now_ns;
  }
}

TrackingState Tracking::state_of(LinkDevice device, bool is_needed, bool may_hold, std::int64_t now_ns) const {
  const Tracked& tracked = of(device);
  if (!tracked.is_there) return is_needed ? TrackingState::waiting : TrackingState::ok;
  if (!tracked.is_valid) return TrackingState::invalid;
  const double silent_s = 1e-9 * static_cast<double>(now_ns - tracked.at_ns);
  return !may_hold && silent_s > options_.stale_s ? TrackingState::stale : TrackingState::ok;
}

TrackingState Tracking::state(std::int64_t now_ns) const {
  for (const TrackingState state :
       {state_of(LinkDevice::tool, true, false, now_ns),
        state_of(LinkDevice::reference, options_.needs_reference, false, now_ns),
        state_of(LinkDevice::patient, options_.needs_patient, !options_.is_patient_tracked, now_ns)}) {
    if (state != TrackingState::ok) return state;
  }
  return TrackingState::ok;
}

std::optional<Pose> Tracking::pose(std::int64_t now_ns) const {
  if (state(now_ns) != TrackingState::ok) return std::nullopt;
  const LinkTransform tool_in_ras = of(LinkDevice::patient).transform * of(LinkDevice::reference).transform.inverse() *
                                    of(LinkDevice::tool).transform;
  return pose_in_lps(tool_in_ras, options_.frame);
}

}  // namespace spinaltap
