#include "core/session/detail/session_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spinaltap {

void WatchedExcess::update(double value, double limit, double slack, const SessionEvent& event,
                           EventLog& log) noexcept {
  if (!is_over_ && value > limit) {
    is_over_ = true;
    index_ = log.add(event);
  } else if (is_over_ && value <= limit - slack) {
    is_over_ = false;
  }
  if (is_over_) log.raise(index_, value, event.place_mm);
}

void WatchedPlunge::start(const SessionEvent& from) noexcept {
  if (is_on_) return;
  is_on_ = true;
  from_ = from;
  max_mm_ = 0.0;
  still_s_ = 0.0;
  index_ = EventLog::kNotKept;
}

void WatchedPlunge::update(const SessionEvent& event, double dt_s, EventLog& log) noexcept {
  constexpr double kStillS = 0.2;   // longer than a tremor's period
  constexpr double kMinMm = 0.001;  // no one stops within less
  if (!is_on_) return;
  const double way_mm = event.depth_mm - from_.depth_mm;
  if (way_mm > max_mm_ + 1e-6) {
    max_mm_ = way_mm;
    still_s_ = 0.0;
    if (index_ == EventLog::kNotKept && way_mm >= kMinMm) {
      from_.kind = EventKind::plunge;
      from_.value = way_mm;
      index_ = log.add(from_);
    }
    log.raise(index_, way_mm, event.place_mm);
    return;
  }
  still_s_ += dt_s;
  if (still_s_ >= kStillS) is_on_ = false;
}

void RecentMax::add(double depth_mm, double value) noexcept {
  if (!(depth_mm - begin_mm_ < kStretchMm)) {
    before_ = now_;
    now_ = 0.0;
    begin_mm_ = depth_mm;
  }
  now_ = std::max(now_, value);
}

SessionWatch::SessionWatch(const DrillPath& path, const OccupiedBone& bone, const SessionOptions& options,
                           bool has_clearances)
    : bit_(tool_body(path.bit)),
      curve_(path),
      bone_(&bone),
      options_(options),
      has_clearances_(has_clearances),
      deepest_mm_(-std::numeric_limits<double>::infinity()) {}

void SessionWatch::take_tool(const DrillBit& bit) {
  bit_ = tool_body(bit);
  is_in_air_ = false;
  tip_is_in_bone_ = false;
  thrust_n_.reset();
}

SessionEvent SessionWatch::event_of(const Cycle& cycle, EventKind kind, const Vec3& place_mm, double value) {
  return {kind, cycle.index, cycle.time_s, cycle.depth_mm, place_mm, value};
}

void SessionWatch::reject(const Cycle& cycle, EventLog& log) noexcept {
  if (rejected_in_a_row_++ == 0) {
    // Where the tip is not known, no place is better than a wrong one.
    rejected_index_ = log.add(event_of(cycle, EventKind::invalid_pose, Vec3::Zero(), 1.0));
  }
  log.raise(rejected_index_, static_cast<double>(rejected_in_a_row_), Vec3::Zero());
}

void SessionWatch::watch_device(const Cycle& cycle, EventLog& log) noexcept {
  const DeviceStatus status = cycle.input.device.status;
  if (status == DeviceStatus::none) return;
  device_gone_s_ = status == DeviceStatus::live ? 0.0 : device_gone_s_ + cycle.input.dt_s;
  const double lost_s = status == DeviceStatus::lost ? device_gone_s_ : 0.0;
  device_.update(lost_s, 0.0, 0.0, event_of(cycle, EventKind::device_lost, cycle.input.pose.tip_mm, lost_s), log);
}

void SessionWatch::jump(const Cycle& cycle, const Pose& pose, double way_mm, EventLog& log) noexcept {
  log.add(event_of(cycle, EventKind::jump, pose.tip_mm, way_mm));
  is_in_air_ = false;
  tip_is_in_bone_ = false;
  thrust_n_.reset();
}

void SessionWatch::update(const Cycle& cycle, const Pose& pose, double state_begin_mm, bool is_cutting,
                          EventLog& log) noexcept {
  rejected_in_a_row_ = 0;
  if (!has_contact_ && cycle.step.removed > 0) {
    has_contact_ = true;
    contact_mm_ = pose.tip_mm;
    log.add(event_of(cycle, EventKind::contact, pose.tip_mm, 0.0));
  }
  if (cycle.state != state_) {
    state_ = cycle.state;
    SessionEvent event = event_of(cycle, EventKind::state, pose.tip_mm, static_cast<double>(state_));
    event.place_mm -= curve_.between_mm(state_begin_mm, cycle.depth_mm);
    event.depth_mm = state_begin_mm;
    log.add(event);
  }
  constexpr double kLeastTouchN = 0.01;
  touch_.update(cycle.force.contact_n.norm(), kLeastTouchN, 0.0,
                event_of(cycle, EventKind::touch, pose.tip_mm, cycle.force.contact_n.norm()), log);
  if (has_clearances_) watch_breaches(cycle, log);
  if (is_cutting) watch_breakthrough(cycle, pose, log);
  watch_volume(cycle, pose, log);
  watch_stops(cycle, pose, log);
  const SessionEvent now = event_of(cycle, EventKind::plunge, pose.tip_mm, 0.0);
  after_stop_.update(now, cycle.input.dt_s, log);
  after_breakthrough_.update(now, cycle.input.dt_s, log);
  deepest_mm_ = std::max(deepest_mm_, cycle.depth_mm);
}

void SessionWatch::watch_breaches(const Cycle& cycle, EventLog& log) noexcept {
  constexpr double kBackMm = 0.05;  // how exact clearances are
  if (!has_contact_) return;        // a bit held beside the bone breaches nothing
  const Clearance& is = cycle.clearance;
  outer_.update(-is.outer_mm, 0.0, kBackMm, event_of(cycle, EventKind::outer_breach, is.outer_at_mm, -is.outer_mm),
                log);
  canal_.update(-is.canal_mm, 0.0, kBackMm, event_of(cycle, EventKind::canal_breach, is.canal_at_mm, -is.canal_mm),
                log);
}

void SessionWatch::watch_breakthrough(const Cycle& cycle, const Pose& pose, EventLog& log) noexcept {
  // Where the volume ends there is no bone to be seen, which does not mean that there is none.
  if (!has_contact_ || !(bone_->past_end_mm(pose.tip_mm) < -bone_->widest_spacing_mm())) return;
  // Cancellous bone may be as light as nothing: where the far surface is known, the tip is through when it is there.
  const bool is_known = knows_surface(cycle);
  if (cycle.force.tip_density_g_cm3 > 0.0 || (is_known && cycle.tip.inside_mm > 0.0)) {
    tip_is_in_bone_ = true;
    is_in_air_ = false;
    thrust_n_.add(cycle.depth_mm, cycle.force.thrust_n);
    return;
  }
  // On the way back there is no bone ahead either, but the hole.
  if (!(cycle.depth_mm > deepest_mm_) || !(tip_is_in_bone_ || is_in_air_)) return;
  if (!is_in_air_) {
    is_in_air_ = true;
    tip_is_in_bone_ = false;
    air_since_mm_ = cycle.depth_mm;
  }
  if (has_clearances_ && !is_known && !outer_.is_over() && !canal_.is_over()) return;
  if (cycle.depth_mm - air_since_mm_ < options_.states.hold_mm - 1e-9) return;
  is_in_air_ = false;
  if (!options_.follows_path) return;
  // The last cycles' thrust fades with the chisel edge in the hole's floor: what the operator felt was that before.
  SessionEvent event = event_of(cycle, EventKind::breakthrough, pose.tip_mm, thrust_n_.value());
  event.place_mm -= curve_.between_mm(air_since_mm_, cycle.depth_mm);
  event.depth_mm = air_since_mm_;
  log.add(event);
  after_breakthrough_.start(event);
}

bool SessionWatch::knows_surface(const Cycle& cycle) const noexcept {
  return has_clearances_ && std::isfinite(cycle.tip.inside_mm);
}

double SessionWatch::beyond_side_mm(const Pose& pose) const noexcept {
  const Vec3 from_mm = has_contact_ ? contact_mm_ : pose.tip_mm;
  if (const auto* profile = std::get_if<BitProfile>(&bit_)) return bone_->beyond_side_mm(*profile, pose, from_mm);
  // A box lies within what its corners lie in.
  const auto* plate = std::get_if<PlateBox>(&bit_);
  if (plate == nullptr) return -std::numeric_limits<double>::infinity();
  const PlateBox& box = *plate;
  const double deep_mm = std::clamp((pose.tip_mm - from_mm).dot(pose.axis), 0.0, box.length_mm());
  const Mat3 rows = plate_rows(pose);
  double most_mm = -std::numeric_limits<double>::infinity();
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Vec3 seen((corner & 1U) != 0 ? box.low_mm().x() : box.high_mm().x(),
                    (corner & 2U) != 0 ? box.low_mm().y() : box.high_mm().y(), (corner & 4U) != 0 ? 0.0 : deep_mm);
    most_mm = std::max(most_mm, bone_->past_end_mm(pose.tip_mm + rows.transpose() * seen));
  }
  return most_mm;
}

void SessionWatch::watch_volume(const Cycle& cycle, const Pose& pose, EventLog& log) noexcept {
  // Before the first contact a bit beside the volume is in the air, or in bone that the volume does not hold: the
  // bone's surface tells, and where that is unknown, whether the bit is deeper than the entry.
  const bool may_be_in_bone = has_contact_ || (knows_surface(cycle) ? cycle.tip.inside_mm > 0.0 : cycle.depth_mm > 0.0);
  double beyond_mm = may_be_in_bone ? beyond_side_mm(pose) : -std::numeric_limits<double>::infinity();
  // Through the far side of the bone, the cylinder's end is not missed.
  if (tip_is_in_bone_) beyond_mm = std::max(beyond_mm, bone_->past_end_mm(pose.tip_mm));
  volume_.update(beyond_mm, bone_->widest_spacing_mm(), bone_->widest_spacing_mm(),
                 event_of(cycle, EventKind::outside_volume, pose.tip_mm, beyond_mm), log);
}

void SessionWatch::stop(const Cycle& cycle, const Pose& pose, EventKind kind, double value, EventLog& log) noexcept {
  bool& has_noted = has_noted_[static_cast<std::size_t>(kind) - static_cast<std::size_t>(EventKind::stop_thrust)];
  if (has_noted) return;
  has_noted = true;
  is_stopped_ = true;
  const SessionEvent event = event_of(cycle, kind, pose.tip_mm, value);
  log.add(event);
  if (options_.follows_path) after_stop_.start(event);
}

void SessionWatch::watch_stops(const Cycle& cycle, const Pose& pose, EventLog& log) noexcept {
  const StopRules& rules = options_.stop;
  const Clearance& is = cycle.clearance;
  if (cycle.force.thrust_n >= rules.thrust_n) stop(cycle, pose, EventKind::stop_thrust, cycle.force.thrust_n, log);
  const double nearer_mm = std::min(is.outer_mm, is.canal_mm);
  // Before the first contact a bit held beside the bone is near to its wall, and harms nothing.
  if (has_contact_ && nearer_mm <= rules.clearance_mm) stop(cycle, pose, EventKind::stop_clearance, nearer_mm, log);
  if (rules.on_breach && (outer_.is_over() || canal_.is_over())) {
    stop(cycle, pose, EventKind::stop_breach, -nearer_mm, log);
  }
}

}  // namespace spinaltap
