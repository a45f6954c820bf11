#pragma once

#include "core/base/geometry.h"

namespace spinaltap {

/// How a path is turned, as surgeons say it. Degrees.
struct PathAngles {
  double convergence_deg = 0.0;  ///< towards the midsagittal plane, seen from above; negative: away from it
  double inclination_deg = 0.0;  ///< upward, of the transverse plane; negative: downward
};

/// Of a direction (unit, patient LPS) from the back to the front. `axes`: Landmarks::axes for the vertebra's own
/// planes, the identity for the patient's. `is_left`: of a path on the patient's left.
PathAngles path_angles(const Vec3& direction, const Mat3& axes, bool is_left);

}  // namespace spinaltap
