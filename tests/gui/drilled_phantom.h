#pragma once

#include <array>
#include <vector>

#include "tests/gui/phantom_bone.h"
#include "vdb/remaining/remaining_bone.h"
#include "vdb/remaining/remaining_surface.h"

namespace spinaltap::test {

/// The phantom, and a hole along its left path from before the entry to the target.
struct DrilledPhantom {
  DrillPath path = phantom_paths().front();
  RemainingBone remaining{phantom_bone()->model(), {.voxel_mm = kSurfaceVoxelMm}};
  RemainingSurface surface{remaining};

  /// What of the surface changes with it.
  std::vector<SurfaceUpdate> drill() {
    const Vec3 axis = path.direction();
    remaining.drill(path.bit, std::array{Pose{path.entry_mm - 8.0 * axis, axis}, Pose{path.target_mm, axis}});
    return surface.update();
  }
};

}  // namespace spinaltap::test
