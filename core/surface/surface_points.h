#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"
#include "core/surface/surface_options.h"

namespace spinaltap {

/// Points on the bone's surface with outward unit normals, patient LPS, mm. Both vectors have one length.
struct SurfacePoints {
  std::vector<Vec3> positions_mm;
  std::vector<Vec3> normals;
};

/// Points where the smoothed mask crosses one half along the voxel grid's lines, refined by the CT's grey values.
/// Throws Error when the mask is empty or its grid is not the CT's, and on smoothing over 20 mm.
SurfacePoints extract_surface(const CtVolume& ct, const BoneMask& mask, const SurfaceOptions& options = {},
                              const Progress& progress = {});

}  // namespace spinaltap
