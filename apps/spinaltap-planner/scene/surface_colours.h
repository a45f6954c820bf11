#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb/grid/bone_model.h"
#include "vdb/remaining/surface_block.h"

namespace spinaltap {

/// Red, green and blue of each vertex of a block, as render_bone() has them before light falls on them: bone in its own
/// colour, darker where other bone stands close around; drilled walls by CT number. `bone`: as it was before it was
/// drilled.
std::vector<std::array<std::uint8_t, 3>> surface_colours(const BoneModel& bone, const SurfaceBlock& block);

}  // namespace spinaltap
