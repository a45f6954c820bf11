#pragma once

#include <memory>
#include <span>

#include "core/base/triangle_mesh.h"
#include "vdb/surface_block.h"

namespace spinaltap {

/// All blocks of a RemainingSurface as one mesh: closed, manifold, outward. Throws Error when blocks do not belong
/// together, so that vertices of one key lie in different places.
TriangleMesh join_blocks(std::span<const std::shared_ptr<const SurfaceBlock>> blocks);

}  // namespace spinaltap
