#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

/// Points on the bone's surface with outward unit normals, patient LPS, mm. Both vectors have one length.
struct SurfacePoints {
  std::vector<Vec3> positions_mm;
  std::vector<Vec3> normals;
};

struct SurfaceOptions {
  /// Width (standard deviation) of the Gaussian that smooths the mask before its surface is taken; 0: chosen from the
  /// voxel size, 0.5 mm or 0.7 of the largest voxel step, whichever is larger.
  double smooth_mm = 0.0;
  /// Whether each point moves along its normal, by at most 1 mm or 0.8 voxel steps, to the cortex's outer edge
  /// (edge_profile.h).
  bool refine_by_hu = true;
};

/// Points where the smoothed mask crosses one half along the voxel grid's lines, refined by the CT's grey values.
/// Throws Error when the mask is empty or its grid is not the CT's, and on smoothing over 20 mm.
SurfacePoints extract_surface(const CtVolume& ct, const BoneMask& mask, const SurfaceOptions& options = {},
                              const Progress& progress = {});

}  // namespace spinaltap
