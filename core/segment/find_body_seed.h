#pragma once

#include "core/segment/bone_levels.h"

namespace spinaltap {

/// A point (patient LPS, mm) in the largest vertebral body of a CT.
///
/// On a lattice of 3 mm, each point looks along 26 directions for bone (in the brightest voxel of about 1 mm that the
/// lattice's block has) and its far side, within 36 mm. Points with walls on nearly all sides lie in bodies (the canal
/// is open above and below); those with the farthest walls are tried with fit_body_cylinder(), and the one of most
/// worth whose middle lies in the CT wins. Throws Error when there is none.
Vec3 find_body_seed(const CtVolume& ct, const BoneLevels& levels);

}  // namespace spinaltap
