#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "apps/spinaltap-planner/scene/vtk_names.h"
#include "vdb/grid/bone_model.h"
#include "vdb/remaining/surface_block.h"

namespace spinaltap {

/// Has an actor lit as render_bone() lights: a lamp to the upper left before the eye, a weaker one to the right, both
/// sides of a surface alike. One cheap shader for all, which processors draw quickly.
void light_softly(vtkActor& actor);

/// The same, for a shell one looks through: clearest where it is seen straight on, so that its outlines stand out.
void light_as_glass(vtkActor& actor);

/// Red, green and blue of each vertex of a block, as render_bone() has them before light falls on them: bone in its own
/// colour, darker where other bone stands close around; drilled walls by CT number. `bone`: as it was before it was
/// drilled.
std::vector<std::array<std::uint8_t, 3>> surface_colours(const BoneModel& bone, const SurfaceBlock& block);

}  // namespace spinaltap
