#pragma once

#include "core/force/drill_forces.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// Sums up places that hold a tool, in the bone's coordinates.
class ContactStiffnessSum {
 public:
  /// A place `from_tip_mm` of the tip that pushes the tool along `direction` (unit) by `push_n`, and by so much more
  /// for each mm that the tool goes against it.
  void add(const Vec3& from_tip_mm, const Vec3& direction, double stiff_n_mm, double push_n) noexcept;
  /// In patient LPS. `factor`: of the forces, not of the stiffness.
  ContactStiffness in_patient(const PathFrame& frame, double factor = 1.0) const noexcept;

 private:
  Vec3 moment_n_mm_ = Vec3::Zero();
  Mat3 ways_ = Mat3::Zero(), turns_ = Mat3::Zero(), mixed_ = Mat3::Zero();  ///< quarters of the stiffness
};

}  // namespace spinaltap
