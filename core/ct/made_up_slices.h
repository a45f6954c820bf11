#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/statistics.h"

namespace spinaltap {

/// Where a CT shows nothing that was scanned: slabs between slices that stand too far apart, filled by interpolation
/// because someone asked for it.
struct MadeUpSlices {
  Vec3 normal = Vec3::UnitZ();       ///< of the slices: unit, patient LPS
  std::vector<Interval> slabs_mm{};  ///< along it, from patient LPS' origin; ascending, apart from each other

  /// Whether one of them reaches to within `reach_mm` of a point, along the normal.
  bool holds(const Vec3& p_mm, double reach_mm = 0.0) const;
};

/// As the metadata "made_up_slices_mm" (the normal, then each slab's ends) of a CT or of a bone, and back. Nothing is
/// added where there are none; nothing is read where there is no such metadata, or it is no such numbers.
void add_made_up(const MadeUpSlices& slices, std::map<std::string, std::string>& metadata);
std::optional<MadeUpSlices> made_up_in(const std::map<std::string, std::string>& metadata);

}  // namespace spinaltap
