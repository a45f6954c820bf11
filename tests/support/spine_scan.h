#pragma once

#include <cmath>
#include <numbers>

#include "core/base/random.h"
#include "core/phantom/scanner.h"
#include "core/phantom/spine_ground_truth.h"
#include "core/phantom/true_labels.h"

namespace spinaltap::test {

/// The part of a phantom that a scan of the spine shows: its vertebrae and sacrum with `margin_mm` beside, in front,
/// behind, above and below; ribs go on beyond it.
inline Box3 box_of_vertebrae(const Spine& spine, const Vec3& margin_mm = Vec3(25.0, 15.0, 8.0)) {
  Box3 box;
  for (std::size_t n = 0; n < spine.part_count(); ++n) {
    if (spine.part(n).label != kRibLabel) box.extend(spine.part(n).solid->bounds_mm());
  }
  box.min() -= margin_mm;
  box.max() += margin_mm;
  return box;
}

/// A quick scan: 1 mm pixels, 1.5 mm slices, one sample a voxel, 12 HU of noise.
inline ScanOptions coarse_scan_options() {
  ScanOptions options;
  options.pixel_mm = 1.0;
  options.slice_step_mm = 1.5;
  options.slice_width_mm = 1.5;
  options.samples_per_pixel = 1;
  options.samples_per_step = 1;
  return options;
}

/// Scans a spine made from SpineOptions in soft tissue.
inline CtVolume scan_spine(const Spine& spine, const ScanOptions& options = coarse_scan_options()) {
  return scan(spine, SoftTissue(spine), scan_of_box(box_of_vertebrae(spine), options));
}

/// The vertebra of a level in closed form. The spine must have it.
inline const Vertebra& vertebra_of(const Spine& spine, Level level) {
  return *spine.part(spine.part_of(level).value()).vertebra;
}

/// A random place in a vertebra's body, up to `share` of the way from its middle to its walls and endplates.
inline Vec3 place_in_body(const Vertebra& vertebra, double share, std::uint64_t seed, std::uint64_t n) {
  const VertebraAnatomy::Body& body = vertebra.anatomy().body;
  const double turn = 2.0 * std::numbers::pi * random_uniform(seed, 3 * n);
  const double out = share * std::sqrt(random_uniform(seed, 3 * n + 1));
  const double up = share * (2.0 * random_uniform(seed, 3 * n + 2) - 1.0);
  return vertebra.to_patient(
      0.5 * Vec3(out * std::cos(turn) * body.width_mm, out * std::sin(turn) * body.depth_mm, up * body.height_mm));
}

}  // namespace spinaltap::test
