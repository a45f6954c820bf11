#pragma once

#include <cstdint>
#include <string_view>

#include "core/base/geometry.h"

namespace spinaltap {

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

struct SessionEvent {
  EventKind kind = EventKind::contact;
  std::uint64_t cycle = 0;
  double time_s = 0.0;
  double depth_mm = 0.0;         ///< of the tip along the path: 0 at the entry
  Vec3 place_mm = Vec3::Zero();  ///< patient LPS: of the tip, or where the breach is
  double value = 0.0;            ///< see EventKind
};

}  // namespace spinaltap
