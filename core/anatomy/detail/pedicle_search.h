#pragma once

#include <optional>

#include "core/anatomy/bone_shape.h"
#include "core/anatomy/landmarks.h"

namespace spinaltap {

/// Where a pedicle is to be looked for.
struct PedicleRegion {
  Mat3 axes;                     ///< of the vertebra: columns left, back, top
  Vec3 canal_mm;                 ///< a place in the canal's middle
  double canal_radius_mm = 0.0;  ///< of the widest cylinder in the canal
  double lowest_mm = 0.0;        ///< of the isthmus, along the top axis from canal_mm: the body's lower end
  double highest_mm = 0.0;       ///< and its upper one
};

/// The isthmus of the pedicle on one side: among plane sections of the bone between arch and body the one of least
/// area. Found over position and both tilts by a coarse search, then where a cubic form through the areas of 729
/// sections around has its minimum: the smallest area itself is moved by the surface's noise, and the minimum of a
/// quadratic form by fillets that begin nearer on one side. `side`: 1 for the left, -1 for the right. Nothing where no
/// bone joins the arch to the body.
std::optional<PedicleLandmarks> find_pedicle(const BoneShape& bone, const PedicleRegion& region, double side);

}  // namespace spinaltap
