#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace spinaltap {

// CT numbers in eight bits: steps of 16 HU from -1024 to 3056.
inline constexpr int kLowestHuOfByte = -1024;
inline constexpr int kHuOfByteStep = 16;

/// The nearest that there is. `hu` must be a number.
inline std::uint8_t byte_of_hu(double hu) {
  return static_cast<std::uint8_t>(std::lround(std::clamp((hu - kLowestHuOfByte) / kHuOfByteStep, 0.0, 255.0)));
}
inline std::int16_t hu_of_byte(std::uint8_t byte) {
  return static_cast<std::int16_t>(kLowestHuOfByte + kHuOfByteStep * byte);
}

}  // namespace spinaltap
