#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/tool/drill_bit.h"

namespace spinaltap {

/// A sentence for each number beyond the range of the tool's shape (BitShapeTraits::speeds), with what it may have been
/// meant as; a spindle at 0 is off.
std::vector<std::string> speed_warnings(const DrillBit& bit, const std::vector<double>& feeds_mm_s,
                                        std::optional<double> rpm);

}  // namespace spinaltap
