#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string_view>

#include "core/base/geometry.h"
#include "core/engine/step_result.h"
#include "core/force/drill_force.h"
#include "core/heat/thermal_bone.h"
#include "core/session/drill_state.h"
#include "core/session/operator/operator.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// How far a bit's surface is from the bone's walls: negative by how far it is beyond them. Infinite where the bone has
/// no such wall, or the bit is not near it.
struct Clearance {
  double outer_mm = std::numeric_limits<double>::infinity();
  double canal_mm = std::numeric_limits<double>::infinity();
  Vec3 outer_at_mm = Vec3::Zero();  ///< place on the bit's axis where it is least, patient LPS
  Vec3 canal_at_mm = Vec3::Zero();
};

/// Where a tool's tip is in the bone.
struct TipPlace {
  double inside_mm = std::numeric_limits<double>::infinity();  ///< to the bone's surface, in it; negative: beyond it
  /// How far the bone goes on along the axis: to the far surface, or into the canal. Infinite where that is further
  /// than ClearanceField::kAheadMm or not known, 0 outside the bone.
  double ahead_mm = std::numeric_limits<double>::infinity();
};

/// What one cycle was and did.
struct Cycle {
  std::uint64_t index = 0;
  double time_s = 0.0;  ///< since the first input; the sum of dt_s, rounded once
  ToolInput input;      ///< as the operator gave it
  Pose pose;            ///< of the bit: the input's, but for what gives way in a compliant tool
  /// Of the tip along the path, straight or curved: 0 at the entry. Without a path below the bone's surface: negative
  /// outside, minus infinity far outside, and 0 where there are no clearances to tell.
  double depth_mm = 0.0;
  StepResult step;
  DrillForce force;
  Clearance clearance;
  TipPlace tip;  ///< infinite without clearances, and of a milling with a path
  DrillState state = DrillState::initial;
  CycleHeat heat;
};

/// What may happen in a session. Numbers are what records store: only add at the end.
enum class EventKind : std::uint8_t {
  contact = 0,          ///< the bit first removes bone
  state = 1,            ///< a new DrillState; value: its number
  outer_breach = 2,     ///< the bit goes beyond the outer surface; value: how deep at most until it is back, mm
  canal_breach = 3,     ///< into the canal; value: likewise
  breakthrough = 4,     ///< the tip leaves the bone at the far side; value: max thrust of the last mm before, N
  stop_thrust = 5,      ///< a limit asks to stop; value: thrust, N
  stop_clearance = 6,   ///< value: clearance, mm
  stop_breach = 7,      ///< value: depth of the breach, mm
  plunge = 8,           ///< after a stop or a breakthrough there; value: how far the tip still goes until it stands, mm
  invalid_pose = 9,     ///< not finite, no direction, no time, or 10 m away: the cycle did nothing; value: in a row
  jump = 10,            ///< the tip moved further than the limit in one cycle; value: how far, mm. The way is not cut
  outside_volume = 11,  ///< the bit is where no points or voxels are and bone may be; value: how far at most, mm
  record_lost = 12,     ///< the record cannot be written any more; value: cycles not recorded
  touch = 13,        ///< the bit is pressed on bone with the spindle off; value: max contact force until it is free, N
  gave_up = 14,      ///< the operator ended short of its target, unasked; value: how far short, mm
  stall = 15,        ///< a compliant tool's motor stands; value: the torque that held it, N·mm
  heat_limit = 16,   ///< bone beside the hole is hotter than the limit; value: how hot at most until it is cooler, °C
  device_lost = 17,  ///< no pose of the device that moves the tool: it stands; value: for how long in all, s
  tool_change = 18   ///< another tool from this cycle on; value: its number, 1 for the session's second tool
};
/// "contact", "state", "outer breach", ...
std::string_view name_of(EventKind kind);

/// What happened in a session, and when.
struct SessionEvent {
  EventKind kind = EventKind::contact;
  std::uint64_t cycle = 0;
  double time_s = 0.0;
  double depth_mm = 0.0;         ///< of the tip along the path: 0 at the entry
  Vec3 place_mm = Vec3::Zero();  ///< patient LPS: of the tip, or where the breach is
  double value = 0.0;            ///< see EventKind
};

/// What is told of each cycle; the reference holds until it returns.
using CycleObserver = std::function<void(const Cycle&)>;

}  // namespace spinaltap
