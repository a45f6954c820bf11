#pragma once

#include <optional>
#include <string>

#include "core/base/geometry.h"
#include "core/tool/drill_bit.h"
#include "core/tool/pedicle_screw.h"

namespace spinaltap {

/// A straight planned hole: from the entry on the bone's surface to the target inside.
struct DrillPath {
  std::string name;
  Vec3 entry_mm = Vec3::Zero();   ///< patient LPS
  Vec3 target_mm = Vec3::Zero();  ///< patient LPS
  DrillBit bit;
  std::optional<PedicleScrew> screw = {};  ///< that the hole is for; its tip comes to the target

  double length_mm() const { return (target_mm - entry_mm).norm(); }
  /// Unit, from entry to target.
  Vec3 direction() const { return (target_mm - entry_mm).normalized(); }
};

/// Refuses points that are not finite, a path shorter than 0.1 mm or longer than 500 mm, and a bad bit or screw.
void check_path(const DrillPath& path);

}  // namespace spinaltap
