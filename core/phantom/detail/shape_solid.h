#pragma once

#include <algorithm>
#include <utility>

#include "core/phantom/detail/near_distance.h"
#include "core/phantom/solid.h"

namespace spinaltap {

/// A cortical shell around an even core.
struct ShellBone {
  double cortex_mm = 1.0;
  double cortex_hu = 1100.0;
  double core_hu = 180.0;
};

/// An implicit shape of shapes.h in its own frame, mirrored or not, placed in the patient, as a body of bone.
template <class Shape>
class ShapeSolid : public Solid {
 public:
  /// `side`: 1, or -1 for the mirror image at x = 0.
  ShapeSolid(Shape shape, const Mat3& rotation, const Vec3& position_mm, double side, const ShellBone& bone)
      : shape_(std::move(shape)), rotation_(rotation), position_mm_(position_mm), side_(side), bone_(bone) {}

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                std::span<Vec3> gradients) const override {
    constexpr double kStep = 1e-5;
    for (std::size_t n = 0; n < points_mm.size(); ++n) {
      values_mm[n] = value_mm(points_mm[n]);
      if (gradients.empty()) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = kStep * Vec3::Unit(axis);
        gradients[n][axis] = (value_mm(points_mm[n] + step) - value_mm(points_mm[n] - step)) / (2.0 * kStep);
      }
    }
  }

  Box3 bounds_mm() const override {
    Box3 box;
    for (int n = 0; n < 8; ++n) {
      Vec3 corner = shape_.bounds().corner(static_cast<Box3::CornerType>(n));
      corner.x() *= side_;
      box.extend(rotation_ * corner + position_mm_);
    }
    return box;
  }

  double hu(const Vec3&, double distance_mm, double aperture_mm) const override {
    const double in_core = aperture_mm > 0.0 ? std::clamp(0.5 - (distance_mm + bone_.cortex_mm) / aperture_mm, 0.0, 1.0)
                                             : (distance_mm < -bone_.cortex_mm ? 1.0 : 0.0);
    return bone_.cortex_hu + in_core * (bone_.core_hu - bone_.cortex_hu);
  }

 private:
  double value_mm(const Vec3& p_patient) const {
    Vec3 p = rotation_.transpose() * (p_patient - position_mm_);
    p.x() *= side_;
    return shapes::near_distance_mm(shape_, p);
  }

  Shape shape_;
  Mat3 rotation_;
  Vec3 position_mm_;
  double side_;
  ShellBone bone_;
};

}  // namespace spinaltap
