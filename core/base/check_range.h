#pragma once

#include "core/base/error.h"

namespace spinaltap {

/// Rejects what is no number from `lowest` to `highest`: "compliance: expected a bite (mm) from 0 to 10, found 12".
inline void check_range(double value, double lowest, double highest, const char* whose, const char* what) {
  if (!(value >= lowest && value <= highest)) {
    fail(whose, ": expected ", what, " from ", lowest, " to ", highest, ", found ", value);
  }
}

}  // namespace spinaltap
