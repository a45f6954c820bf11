#pragma once

#include <algorithm>
#include <cmath>

#include "core/anatomy/bone_shape.h"

namespace spinaltap {

/// How far along start + s * direction (unit) the bone's lattice first changes its sign, from inside to outside or the
/// other way; `max_mm` when it does not until there. Right to about 0.02 mm, for searches.
inline double way_to_surface_mm(const BoneShape& bone, const Vec3& start_mm, const Vec3& direction, double max_mm) {
  constexpr double kMinStepMm = 0.2, kStepOutsideMm = 0.4;
  constexpr int kSecants = 3;
  double here_mm = 0.0, here = bone.lattice_mm(start_mm);
  const bool inside = here < 0.0;
  while (here_mm < max_mm) {
    // Outside, the lattice's values may be larger than the way to the bone.
    const double step_mm = inside ? std::max(kMinStepMm, -0.9 * here) : kStepOutsideMm;
    double next_mm = std::min(here_mm + step_mm, max_mm);
    double next = bone.lattice_mm(start_mm + next_mm * direction);
    if ((next < 0.0) == inside) {
      here_mm = next_mm;
      here = next;
      continue;
    }
    for (int n = 0; n < kSecants; ++n) {
      const double middle_mm = here_mm + (next_mm - here_mm) * here / (here - next);
      const double middle = bone.lattice_mm(start_mm + middle_mm * direction);
      if ((middle < 0.0) == inside) {
        here_mm = middle_mm;
        here = middle;
      } else {
        next_mm = middle_mm;
        next = middle;
      }
      if (here == next) break;
    }
    return here == next ? here_mm : here_mm + (next_mm - here_mm) * here / (here - next);
  }
  return max_mm;
}

}  // namespace spinaltap
