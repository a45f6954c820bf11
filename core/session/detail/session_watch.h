#pragma once

#include <limits>
#include <span>
#include <vector>

#include "core/points/occupied_bone.h"
#include "core/session/cycle.h"
#include "core/session/drill_session.h"
#include "core/tool/path_curve.h"
#include "core/tool/tool_body.h"

namespace spinaltap {

/// The events of a session, in the order in which they began. Has room for all that are kept from the start, so that
/// noting one allocates nothing; further ones are counted only.
class EventLog {
 public:
  static constexpr std::size_t kNotKept = std::numeric_limits<std::size_t>::max();

  explicit EventLog(std::size_t max) { events_.reserve(max); }

  /// Its index, or kNotKept.
  std::size_t add(const SessionEvent& event) noexcept {
    if (events_.size() == events_.capacity()) {
      ++lost_;
      return kNotKept;
    }
    events_.push_back(event);
    return events_.size() - 1;
  }
  /// Gives an event a larger value, and the place that goes with it.
  void raise(std::size_t index, double value, const Vec3& place_mm) noexcept {
    if (index >= events_.size() || !(value > events_[index].value)) return;
    events_[index].value = value;
    events_[index].place_mm = place_mm;
  }

  std::span<const SessionEvent> events() const { return events_; }
  std::size_t lost() const { return lost_; }

 private:
  std::vector<SessionEvent> events_;
  std::size_t lost_ = 0;
};

/// Follows a value that is over a limit for a while: one event from when it goes over until it is back, which keeps the
/// largest value.
class WatchedExcess {
 public:
  /// Over at `value` above `limit`; back at or below `limit - slack`, so that a trembling operator brings one event and
  /// not hundreds. `event` is what is noted at the begin.
  void update(double value, double limit, double slack, const SessionEvent& event, EventLog& log) noexcept;
  bool is_over() const { return is_over_; }

 private:
  bool is_over_ = false;
  std::size_t index_ = EventLog::kNotKept;
};

/// How far the tip still goes after something that should have made the operator stop.
class WatchedPlunge {
 public:
  /// Begins to count at the tip's depth `from`.
  void start(const SessionEvent& from) noexcept;
  /// After a cycle. `event`: of now. It has stood still when it has not gone deeper for a while.
  void update(const SessionEvent& event, double dt_s, EventLog& log) noexcept;

 private:
  bool is_on_ = false;
  SessionEvent from_;
  double max_mm_ = 0.0;
  double still_s_ = 0.0;
  std::size_t index_ = EventLog::kNotKept;
};

/// The largest of a value over the last half to whole millimetre of depth.
class RecentMax {
 public:
  void add(double depth_mm, double value) noexcept;
  void reset() noexcept { *this = RecentMax(); }
  double value() const { return before_ > now_ ? before_ : now_; }

 private:
  static constexpr double kStretchMm = 0.5;
  double begin_mm_ = 0.0;  ///< of the stretch under way
  double now_ = 0.0;
  double before_ = 0.0;
};

/// Makes events of what cycles did, and tells when to stop. Allocates nothing.
class SessionWatch {
 public:
  /// `bone` must outlive this.
  SessionWatch(const DrillPath& path, const OccupiedBone& bone, const SessionOptions& options, bool has_clearances);

  /// After a cycle that moved the bit to `pose`. `state_begin_mm`: where the cycle's state began. `is_cutting`: the
  /// spindle was on.
  void update(const Cycle& cycle, const Pose& pose, double state_begin_mm, bool is_cutting, EventLog& log) noexcept;
  /// After a cycle whose pose made no sense. A row of them is one event.
  void reject(const Cycle& cycle, EventLog& log) noexcept;
  /// Of each cycle, before its update. While a device is lost there is one event.
  void watch_device(const Cycle& cycle, EventLog& log) noexcept;
  /// Before the update of a cycle in which the motor came to stand.
  static void stall(const Cycle& cycle, const Pose& pose, double torque_n_mm, EventLog& log) noexcept {
    log.add(event_of(cycle, EventKind::stall, pose.tip_mm, torque_n_mm));
  }
  /// Before the update of a cycle whose way is not cut.
  void jump(const Cycle& cycle, const Pose& pose, double way_mm, EventLog& log) noexcept;

  /// Another tool, which has come from nowhere.
  void take_tool(const DrillBit& bit);

  bool is_stopped() const { return is_stopped_; }

 private:
  static SessionEvent event_of(const Cycle& cycle, EventKind kind, const Vec3& place_mm, double value);
  void watch_breaches(const Cycle& cycle, EventLog& log) noexcept;
  void watch_breakthrough(const Cycle& cycle, const Pose& pose, EventLog& log) noexcept;
  void watch_volume(const Cycle& cycle, const Pose& pose, EventLog& log) noexcept;
  /// Whether the cycle tells how deep in bone the tip is.
  bool knows_surface(const Cycle& cycle) const noexcept;
  double beyond_side_mm(const Pose& pose) const noexcept;
  void watch_stops(const Cycle& cycle, const Pose& pose, EventLog& log) noexcept;
  void stop(const Cycle& cycle, const Pose& pose, EventKind kind, double value, EventLog& log) noexcept;

  ToolBody bit_;
  PathCurve curve_;
  const OccupiedBone* bone_;
  SessionOptions options_;
  bool has_clearances_;

  bool has_contact_ = false;
  Vec3 contact_mm_ = Vec3::Zero();  ///< the tip at the first contact
  DrillState state_ = DrillState::initial;
  WatchedExcess outer_, canal_, volume_, touch_, device_;
  double device_gone_s_ = 0.0;  ///< since the last that was heard of it
  WatchedPlunge after_stop_, after_breakthrough_;

  double deepest_mm_;
  bool tip_is_in_bone_ = false;
  bool is_in_air_ = false;  ///< and has been in bone before
  double air_since_mm_ = 0.0;
  RecentMax thrust_n_;  ///< while the tip was in bone

  bool is_stopped_ = false;
  bool has_noted_[3] = {false, false, false};  ///< stop events: thrust, clearance, breach
  std::uint64_t rejected_in_a_row_ = 0;
  std::size_t rejected_index_ = EventLog::kNotKept;
};

}  // namespace spinaltap
