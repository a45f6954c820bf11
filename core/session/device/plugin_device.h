#pragma once

#include <filesystem>
#include <memory>

#include "core/session/device/haptic_device.h"

namespace spinaltap {

/// A device of a plug-in (core/session/device/device_plugin.h), which is loaded and opened, and closed again at the
/// end. `options`: the plug-in's own words. Throws Error where there is no such file, it is no shared library for this
/// machine, exports no plug-in, is of another version, lacks a function, rejects to open, or says limits that make no
/// sense.
std::unique_ptr<HapticDevice> open_device_plugin(const std::filesystem::path& library, const std::string& options = {});

}  // namespace spinaltap
