#pragma once

#include <optional>
#include <span>

#include "core/base/view.h"
#include "core/tool/bit_ray.h"
#include "vdb/grid/bone_model.h"
#include "vdb/picture/render.h"

namespace spinaltap {

struct ViewOptions {
  /// What bits took beside what the bone's own grids have lost: swept_along() (vdb/remaining) makes them of ways.
  std::span<const BitBody> removed = {};
  std::optional<RenderedBit> bit = {};
};

/// What a camera sees of a bone and a bit: a ray through the middle of each pixel, to the first place where it comes
/// from outside onto one of them. Solids that the camera stands in are not seen from within.
///
/// The bone's surface and the hole in its grids are where their tri-linear distance is 0, which is what sampling the
/// bone gives, to 1e-5 mm; bit and `removed` are met exactly. Normals of grids are differences over two voxels. The
/// same bits at any number of threads. Throws Error on what is no camera, see check_camera(), and on bad bits.
View view_bone(const BoneModel& bone, const Camera& camera, const ViewOptions& options = {});

}  // namespace spinaltap
