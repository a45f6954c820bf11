#pragma once

namespace spinaltap {

/// How the points of a bone's surface are found in a CT: extract_surface().
struct SurfaceOptions {
  /// Width (standard deviation) of the Gaussian that smooths the mask before its surface is taken; 0: chosen from the
  /// voxel size, 0.5 mm or 0.7 of the largest voxel step, whichever is larger.
  double smooth_mm = 0.0;
  /// Whether each point moves along its normal, by at most 1 mm or 0.8 voxel steps, to the cortex's outer edge
  /// (edge_profile.h).
  bool refine_by_hu = true;
};

/// How a function is laid through them: fit_surface().
struct SurfaceFitOptions {
  double spacing_mm = 0.5;      ///< of points nearer to each other than this one is taken; 0: all of them
  double off_surface_mm = 1.0;  ///< distance of off-surface points, shortened where another part is near
  double smoothing_mm = 1.0;    ///< see FitOptions; chosen by docs/surface-comparison.md
  double accuracy_mm = 0.01;
  double reduction_mm = 0.0;
};

}  // namespace spinaltap
