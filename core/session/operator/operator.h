#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/force/drill_force.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// Whether a device is behind an input, and whether it was heard of. Numbers are what records store.
enum class DeviceStatus : std::uint8_t {
  none = 0,
  live = 1,    ///< a new pose since the last cycle
  silent = 2,  ///< none yet: the last holds
  lost = 3     ///< none for so long that the tool stands and the bone is not cut
};

/// The device's side of a tool that is coupled to one.
struct DeviceSide {
  DeviceStatus status = DeviceStatus::none;
  std::uint32_t buttons = 0;        ///< pressed: a bit each
  Pose pose;                        ///< as it said last, patient LPS
  Vec3 force_n = Vec3::Zero();      ///< that it is told to give, patient LPS
  Vec3 torque_n_mm = Vec3::Zero();  ///< about the tip, likewise
};

/// Where an operator holds the bit at the end of a cycle.
struct ToolInput {
  Pose pose;  ///< patient LPS
  bool spindle_on = true;
  double dt_s = 0.001;  ///< since the last input; above 0
  DeviceSide device = {};
};

/// What an operator feels of the last cycle.
struct ToolFeedback {
  double time_s = 0.0;
  DrillForce force = {};
  bool stop = false;  ///< the session asks to stop drilling: an operator that pushes lets go, others end
  /// What a ball-tip probe would feel at the end of the hole: bone; false where the tip has come through.
  bool has_floor = true;
};

/// How an operator came to its end.
enum class OperatorEnd : std::uint8_t {
  as_planned,     ///< at its target, through all of its poses, or the session asked it to stop
  broke_through,  ///< it felt a breakthrough, and a probe felt no bone
  stood_still,    ///< the bone held all of its push
  ran_out_of_time,
  device_lost  ///< its device was not heard of any more
};
/// "as planned", "broke through", "stood still", "ran out of time", "device lost".
std::string_view name_of(OperatorEnd end);

/// An operator that holds the bit: a planned motion, recorded poses, a device, a model of a surgeon. Asked once a
/// cycle, in order, from one thread. The same feedback brings the same poses.
class Operator {
 public:
  Operator() = default;
  Operator(const Operator&) = delete;
  Operator& operator=(const Operator&) = delete;
  virtual ~Operator() = default;

  /// The next pose; nothing at the end. The first is where the bit is put.
  virtual std::optional<ToolInput> next(const ToolFeedback& feedback) = 0;
  /// How many inputs there will be, for progress; 0: not known.
  virtual std::size_t count() const { return 0; }
  /// Once it has ended.
  virtual OperatorEnd end() const { return OperatorEnd::as_planned; }
};

}  // namespace spinaltap
