#pragma once

#include "core/segment/bone_levels.h"

namespace spinaltap {

/// A point (patient LPS, mm) in the largest vertebral body of a CT.
///
/// On a lattice of 3 mm, each point looks along 26 directions for bone and its far side, within 36 mm. Points with
/// walls on nearly all sides lie in bodies (the canal is open above and below); those with the farthest walls are tried
/// with fit_body_cylinder(), and the one with the most wall in all wins. Throws Error when there is none.
Vec3 find_body_seed(const CtVolume& ct, const BoneLevels& levels);

}  // namespace spinaltap
