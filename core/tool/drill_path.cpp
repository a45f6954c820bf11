#include "core/tool/drill_path.h"

#include "core/base/error.h"

namespace spinaltap {

void check_path(const DrillPath& path) {
  constexpr double kShortestMm = 0.1;
  constexpr double kLongestMm = 500.0;
  if (!path.entry_mm.allFinite() || !path.target_mm.allFinite()) {
    fail("path \"", path.name, "\": entry and target must be finite numbers");
  }
  const double length_mm = path.length_mm();
  if (!(length_mm >= kShortestMm && length_mm <= kLongestMm)) {
    fail("path \"", path.name, "\": expected ", kShortestMm, " to ", kLongestMm, " mm from entry to target, found ",
         length_mm, " mm");
  }
  check_bit(path.bit);
  if (path.screw) check_screw(*path.screw);
}

}  // namespace spinaltap
