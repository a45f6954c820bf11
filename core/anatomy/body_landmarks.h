#pragma once

#include "core/anatomy/bone_shape.h"
#include "core/anatomy/landmarks.h"

namespace spinaltap {

/// The middle of the thickest part of a bone, which in a vertebra is its body, and how deep it lies, mm.
struct Core {
  Vec3 centre_mm = Vec3::Zero();
  double depth_mm = 0.0;
};
Core find_core(const BoneShape& bone);

/// Endplates and sizes of the vertebral body around a place well inside it, with axes of the vertebra (columns left,
/// back, top). The endplates are planes through where straight ways up and down from the body's middle leave the bone,
/// by least squares with Tukey's biweight, so that a Schmorl's node or a spur does not pull them. Throws Error when the
/// body is shorter than 5 mm or has no end within 60 mm.
Landmarks::Body measure_body(const BoneShape& bone, const Vec3& inside_mm, const Mat3& axes);

/// How many bodies lie one above the other, along `superior` through `inside_mm`.
int count_bodies(const BoneShape& bone, const Vec3& inside_mm, const Mat3& axes);

}  // namespace spinaltap
