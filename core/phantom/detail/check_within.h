#pragma once

#include "core/base/error.h"

namespace spinaltap {

/// Throws Error where a value does not lie within bounds, or is NaN. `what` has the value: "anatomy".
inline void check_within(const char* what, const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    fail(what, ": ", name, " must lie in [", low, ", ", high, "], found ", value);
  }
}

}  // namespace spinaltap
