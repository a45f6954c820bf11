#pragma once

#include "core/base/geometry.h"

namespace spinaltap::detail {

/// From patient positions (LPS, mm) to a grid's indices. Each step rounds as OpenVDB's own maps do, so that both find
/// the same index, bit for bit.
struct IndexMap {
  bool axis_aligned = true;          ///< index = (p - origin_mm) * per_mm; otherwise matrix * p + offset
  Vec3 origin_mm = Vec3::Zero();     ///< centre of voxel (0, 0, 0), patient LPS
  Vec3 per_mm = Vec3::Ones();        ///< indices per mm along each axis
  Mat3 matrix = Mat3::Identity();    ///< indices per mm
  Vec3 offset_index = Vec3::Zero();  ///< index of the patient frame's origin

  Vec3 to_index(const Vec3& p_patient) const {
    if (axis_aligned) return (p_patient - origin_mm).cwiseProduct(per_mm);
    Vec3 p_index;
    for (int axis = 0; axis < 3; ++axis) {
      p_index[axis] = p_patient.x() * matrix(axis, 0) + p_patient.y() * matrix(axis, 1) +
                      p_patient.z() * matrix(axis, 2) + offset_index[axis];
    }
    return p_index;
  }

  /// A slope per index as a slope per mm.
  Vec3 gradient_to_patient(const Vec3& gradient_index) const {
    if (axis_aligned) return gradient_index.cwiseProduct(per_mm);
    return matrix.transpose() * gradient_index;
  }
};

}  // namespace spinaltap::detail
