#pragma once

#include <memory>
#include <span>

#include "core/base/triangle_mesh.h"
#include "vdb/grid/bone_model.h"
#include "vdb/remaining/surface_block.h"

namespace spinaltap {

enum class SurfacePart {
  whole,
  bone  ///< without the walls of holes
};

/// All blocks of a RemainingSurface as one mesh: outward, and as a whole closed and manifold. Throws Error when blocks
/// do not belong together, so that vertices of one key lie in different places.
TriangleMesh join_blocks(std::span<const std::shared_ptr<const SurfaceBlock>> blocks,
                         SurfacePart part = SurfacePart::whole);

/// The surface of a bone, drilled or not, in triangles of about its voxels' size: closed, manifold, outward, and sharp
/// where holes begin.
TriangleMesh sharp_surface(const BoneModel& bone);

/// What a tool cut loose on all sides, such as a sliver between two lines of a milling.
struct LooseChips {
  std::size_t count = 0;
  double volume_mm3 = 0.0;
};
/// Takes pieces out of a closed mesh that enclose no more than `max_mm3`, but not its largest: as an operator's suction
/// does. Hollows, which are pieces that face inward, stay.
LooseChips drop_loose_chips(TriangleMesh& mesh, double max_mm3 = 1.0);

}  // namespace spinaltap
