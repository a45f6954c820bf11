#pragma once

#include <cstdint>
#include <span>

#include "core/anatomy/bone_shape.h"
#include "core/base/progress.h"
#include "core/registration/registration.h"

namespace spinaltap {

struct TouchedOptions {
  RigidPose start = {};      ///< ct_from_patient, about: of a few marks, or of an earlier registration
  double search_mm = 20.0;   ///< how far from the start the touched points may lie
  double search_deg = 20.0;  ///< and how far they may be turned
  int starts = 256;          ///< poses in that range from which the search begins; 1: the start alone
  /// Standard deviation of a touched point to each side, mm; 0: not known, found from the residuals.
  double noise_mm = 0.0;
  double max_slide_mm = 1.0;  ///< a motion of the touched points that may be larger, one deviation, is warned of
  /// An error to expect in the inner half of the bone's box that is larger, root mean square, is warned of: touched
  /// points may hold themselves and not what lies beyond them.
  double max_target_mm = 1.2;
  std::uint64_t seed = 1;  ///< of where the search begins
};

/// From points touched on the bone's surface, as a tracker measured them on the patient, mm. Iterated closest points
/// (Besl & McKay, "A method for registration of 3-D shapes", IEEE Trans. PAMI 1992) on the signed distance, each step
/// that of point to plane (Chen & Medioni, "Object modelling by registration of multiple range images", Image Vis.
/// Comput. 1992), from many poses about the start. Far from the surface weights are those of Geman & McClure, with a
/// scale that narrows (Zhou, Park & Koltun, "Fast global registration", ECCV 2016); near it points that lie beyond 3.5
/// deviations are left out. The covariance is that of least squares with these normals. Never silently wrong: see the
/// result's warnings. Throws Error on fewer than 12 touched points, on what is not finite, on points that spread over
/// less than 5 mm or more than 0.5 m, and on a search that makes no sense.
Registration register_surface(const BoneShape& bone, std::span<const Vec3> touched_mm,
                              const TouchedOptions& options = {}, const Progress& progress = {});

}  // namespace spinaltap
