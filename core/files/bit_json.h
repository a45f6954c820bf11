#pragma once

#include "core/files/json_file.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// A tool as plans hold it; docs/plan-file.md.
Json bit_json(const DrillBit& bit);

}  // namespace spinaltap
