#include "core/session/device/open_device.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/session/device/loopback_device.h"
#include "core/session/device/plugin_device.h"

namespace spinaltap {
namespace {

constexpr std::string_view kLoopbackName = "loopback";

double loopback_number(const std::string& name, const std::string& value, double min, double max) {
  const std::optional<double> number = parse_number(value);
  if (!number || !(*number >= min && *number <= max)) {
    fail("loopback device: expected ", name, "= from ", min, " to ", max, ", found ", in_quotes(value));
  }
  return *number;
}

LoopbackOptions loopback_options(const std::string& settings) {
  constexpr double kHandN_mm = 0.05;  // a soft hand: what it pushes with hardly changes as the bit goes in
  constexpr double kHandNS_mm = 1.0;  // and a steady one: where the bone gives way, it goes on by some mm/s
  constexpr double kLeansMmS = 300.0;
  constexpr double kEncoderMm = 160.0 / 4096.0;
  double push_n = 7.0, delay_s = 0.001;
  LoopbackOptions options;
  options.hand.presses_from_s = 10.0;
  std::istringstream parts(settings);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t equals = std::min(part.find('='), part.size());
    const std::string name = part.substr(0, equals);
    const std::string value = part.substr(std::min(equals + 1, part.size()));
    if (name == "push") {
      push_n = loopback_number(name, value, 0.0, 50.0);
    } else if (name == "delay") {
      delay_s = loopback_number(name, value, 0.0, 0.1);
    } else if (name == "seconds") {
      options.hand.presses_from_s = loopback_number(name, value, 0.01, 3600.0);
    } else if (name == "pulled") {
      options.silent_from_s = loopback_number(name, value, 0.0, 3600.0);
    } else if (name == "seed") {
      constexpr double kMaxSeed = 1e15;  // that a double has whole
      options.seed = static_cast<std::uint64_t>(loopback_number(name, value, 0.0, kMaxSeed));
    } else {
      fail("loopback device: expected push=, delay=, seconds=, pulled= or seed=, found ", in_quotes(part));
    }
  }
  options.limits.position_step_mm = kEncoderMm;
  options.pose_delay_s = options.force_delay_s = 0.5 * delay_s;
  options.hand.stiffness_n_mm = kHandN_mm;
  options.hand.damping_n_s_mm = kHandNS_mm;
  options.hand.push_mm = push_n / kHandN_mm;
  options.hand.push_mm_s = kLeansMmS;
  options.hand.tremor_mm = 0.1;
  options.hand.buttons = 1U << kSpindleButton;
  options.hand.presses = 1U << kEndButton;
  return options;
}

}  // namespace

bool is_loopback_name(std::string_view name) {
  return name == kLoopbackName || (name.starts_with(kLoopbackName) && name.at(kLoopbackName.size()) == ':');
}

std::unique_ptr<HapticDevice> open_device(const std::string& name) {
  const std::size_t colon = name.find(':');
  const std::string settings = colon == std::string::npos ? "" : name.substr(colon + 1);
  if (is_loopback_name(name)) return std::make_unique<LoopbackDevice>(loopback_options(settings));
  // A file whose own name has a colon is that file.
  std::error_code none;
  if (colon == std::string::npos || std::filesystem::is_regular_file(name, none)) return open_device_plugin(name);
  return open_device_plugin(name.substr(0, colon), settings);
}

}  // namespace spinaltap
