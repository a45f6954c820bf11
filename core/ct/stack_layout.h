#pragma once

#include <string>

#include "core/base/geometry.h"

namespace spinaltap {

/// What the positions of a series say, judged or not.
struct StackLayout {
  Mat3 directions;             ///< as GridGeometry's
  double least_step_mm = 0.0;  ///< along the normal
  double most_step_mm = 0.0;
  double tilt_rad = 0.0;  ///< between the normal and the line of the slices' first pixels
};

/// The plane of slices with this normal (unit, patient LPS): "axial", "coronal" or "sagittal" within 3 degrees,
/// otherwise "oblique, near axial" and so on.
std::string plane_name(const Vec3& normal);

}  // namespace spinaltap
