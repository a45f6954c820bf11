#pragma once

#include <cstdint>
#include <optional>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"
#include "core/phantom/solid.h"
#include "core/phantom/surroundings.h"

namespace spinaltap {

/// A virtual CT scanner. The defaults give the resolution of the paper's scans.
struct ScanOptions {
  int columns = 512;
  int rows = 512;
  int slices = 95;
  double pixel_mm = 0.352;
  double slice_step_mm = 0.5;
  double slice_width_mm = 1.1;  ///< width of the box over which a slice averages
  double blur_mm = 0.35;        ///< standard deviation of the Gaussian blur in the slice; 0: none
  /// Of the kernel: 0 for the Gaussian, a soft one; above it edges are enhanced and overshoot, as a bone or lung kernel
  /// has them (1 to 3). Noise has the kernel's grain.
  double sharpness = 0.0;
  double noise_hu = 12.0;         ///< standard deviation of the noise, after it was blurred like the image
  std::uint64_t seed = 1;         ///< of the noise
  double surroundings_hu = 40.0;  ///< soft tissue; -1000 is air
  int samples_per_pixel = 2;      ///< of the ideal image, along each side of a pixel
  int samples_per_step = 2;       ///< of the ideal image, along z, in each slice step
  /// Middle of the field of view, patient LPS, mm; nothing: that of the solid's bounds.
  std::optional<Vec3> centre_mm{};
};

/// `options` with as many columns, rows and slices as a box (patient LPS, mm) needs, and its middle. What the box cuts
/// off is not scanned.
ScanOptions scan_of_box(const Box3& box_mm, const ScanOptions& options);

/// Images `solid`, with the field of view centred on its bounds and axes along the patient's.
///
/// The ideal CT number is sampled on a lattice finer than the pixels: the body's own, mixed with the surroundings by
/// how much of a cell lies inside. It is averaged over the slice profile and blurred; then noise is added. The same
/// seed gives the same voxels at any number of threads. Throws Error on options without sense, Cancelled on cancel.
CtVolume scan(const Solid& solid, const ScanOptions& options = {}, const Progress& progress = {});

/// As above, but the solid lies in `surroundings` and not in an even surroundings_hu. They are sampled once a voxel.
CtVolume scan(const Solid& solid, const Surroundings& surroundings, const ScanOptions& options = {},
              const Progress& progress = {});

}  // namespace spinaltap
