#pragma once

#include <cstdint>
#include <string>

#include "core/session/coupling/coupling_gains.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// What a device says of itself at one moment, in its own coordinates: right-handed, mm.
struct DeviceSample {
  Pose pose;  ///< of what it holds: unit axis; side as Pose has it. Of a device that senses no turn: as it was opened
  std::uint32_t buttons = 0;  ///< pressed: a bit each
  double time_s = 0.0;        ///< by its own clock: a new sample has another
};

/// A device that a hand holds: it has a pose and may give a force. Asked from one thread.
class HapticDevice {
 public:
  HapticDevice() = default;
  HapticDevice(const HapticDevice&) = delete;
  HapticDevice& operator=(const HapticDevice&) = delete;
  virtual ~HapticDevice() = default;

  virtual const std::string& name() const = 0;
  virtual const DeviceLimits& limits() const = 0;
  /// The latest sample. False where there is none since the last that was read. Waits for nothing.
  virtual bool read(DeviceSample& sample) noexcept = 0;
  /// From now on: N and N·mm about the tip of the last sample, in its own coordinates. False where it does not take
  /// them.
  virtual bool give(const Vec3& force_n, const Vec3& torque_n_mm) noexcept = 0;
};

}  // namespace spinaltap
