#pragma once

#include <map>
#include <string>

#include "core/tool/drill_bit.h"

namespace spinaltap {

/// Shapes of bits by the names that they have in options and plans.
const std::map<std::string, BitShape>& bit_shapes();

/// "drill", "round-burr", "conical-burr" or "tapered-screw".
const std::string& name_of(BitShape shape);

}  // namespace spinaltap
