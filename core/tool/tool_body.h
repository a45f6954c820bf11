#pragma once

#include <variant>

#include "core/tool/bit_profile.h"
#include "core/tool/plate.h"

namespace spinaltap {

/// What a tool fills: a body of revolution, or a plate's box.
using ToolBody = std::variant<BitProfile, PlateBox>;

/// Throws Error as check_bit does.
inline ToolBody tool_body(const DrillBit& bit) {
  if (bit.shape == BitShape::plate) return PlateBox(bit);
  return BitProfile(bit);
}

/// From the tip back to the base.
inline double tool_length_mm(const ToolBody& body) {
  return std::visit([](const auto& one) { return one.length_mm(); }, body);
}

}  // namespace spinaltap
