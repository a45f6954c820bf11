#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/session/device/haptic_device.h"

namespace spinaltap {

/// Of a device's buttons, by the bits of DeviceSample::buttons: what a session that open_device() serves takes them
/// for.
inline constexpr unsigned kSpindleButton = 0;
inline constexpr unsigned kEndButton = 1;

/// A device by its name, as on a command line:
///
/// - "loopback", or "loopback:push=7,delay=0.001,seconds=10,seed=1": a simulated device (LoopbackDevice) of 8 N, 12
///   bits over 160 mm and so much delay (s), held by a hand with a tremor that holds the spindle's button, leans
///   forwards with so much force (N) and presses kEndButton after so long; "pulled=2": its cable is, after 2 s;
/// - "FILE.so", or "FILE.so:SETTINGS": a plug-in (open_device_plugin()) and its own words.
///
/// Throws Error where there is no such device, or it cannot be opened.
std::unique_ptr<HapticDevice> open_device(const std::string& name);

/// Whether it is the simulated one, which goes as fast as it is asked, and not by a clock of its own.
bool is_loopback_name(std::string_view name);

}  // namespace spinaltap
