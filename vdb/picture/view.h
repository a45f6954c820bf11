#pragma once

#include <optional>

#include "core/base/view.h"
#include "vdb/grid/bone_model.h"
#include "vdb/picture/render.h"
#include "vdb/remaining/hole_cutter.h"

namespace spinaltap {

/// What a camera sees of a bone and a bit: a ray through the middle of each pixel, to the first place where it comes
/// from outside onto one of them. Solids that the camera stands in are not seen from within.
///
/// The bone's surface and the hole in its grids are where their tri-linear distance is 0, which is what sampling the
/// bone gives, to 1e-5 mm; the bit is met exactly. Normals of grids are differences over two voxels. The same bits at
/// any number of threads. Throws Error on what is no camera, see check_camera(), and on bad bits.
View view_bone(const BoneModel& bone, const Camera& camera, const std::optional<RenderedBit>& bit = {});
/// The same of HoleCutter's bone while it is drilled.
View view_bone(const CutHole& bone, const Camera& camera, const std::optional<RenderedBit>& bit = {});

}  // namespace spinaltap
