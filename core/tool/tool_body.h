#pragma once

#include <variant>

#include "core/tool/bit_profile.h"
#include "core/tool/plate.h"

namespace spinaltap {

/// What a tool fills: a body of revolution, or a plate's box.
using ToolBody = std::variant<BitProfile, PlateBox>;

/// Throws Error as check_bit does.
inline ToolBody tool_body(const DrillBit& bit) {
  if (bit.is_plate()) return PlateBox(bit);
  return BitProfile(bit);
}

/// From the tip back to the base.
inline double tool_length_mm(const ToolBody& body) noexcept {
  if (const auto* plate = std::get_if<PlateBox>(&body)) return plate->length_mm();
  const auto* profile = std::get_if<BitProfile>(&body);
  return profile != nullptr ? profile->length_mm() : 0.0;
}

}  // namespace spinaltap
