#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "core/anatomy/bone_shape.h"
#include "core/anatomy/landmarks.h"
#include "core/anatomy/wall_distance.h"
#include "core/phantom/vertebra.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/gridded_field.h"

namespace spinaltap::test {

/// A body of bone by a formula for its distance, with a canal along z and landmarks that make a vertebra of it: its
/// left is +x, its back +y, its top +z.
class FormulaBone {
 public:
  using Formula = std::function<double(const Vec3&)>;

  FormulaBone(const Formula& value_mm, const Box3& bounds_mm, double canal_radius_mm, double pedicle_mm) {
    const auto gradient = [value_mm](const Vec3& p) -> Vec3 {
      constexpr double kStepMm = 1e-4;
      Vec3 slope;
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = kStepMm * Vec3::Unit(axis);
        slope[axis] = (value_mm(p + step) - value_mm(p - step)) / (2.0 * kStepMm);
      }
      return slope;
    };
    bone_ = std::make_unique<BoneShape>(std::make_shared<FormulaField>(value_mm, gradient), bounds_mm, 0.75);
    for (const Vec3& p : bone_->points_mm()) {
      landmarks_.is_canal_wall.push_back(std::hypot(p.x(), p.y()) < canal_radius_mm + 0.01 ? 1 : 0);
    }
    landmarks_.left_pedicle.isthmus_mm = Vec3(pedicle_mm, 0.0, 0.0);
    landmarks_.right_pedicle.isthmus_mm = Vec3(-pedicle_mm, 0.0, 0.0);
    for (PedicleLandmarks* pedicle : {&landmarks_.left_pedicle, &landmarks_.right_pedicle}) {
      pedicle->width_mm = 2.0 * (pedicle_mm - canal_radius_mm);
      pedicle->height_mm = 8.0;
    }
  }

  const BoneShape& bone() const { return *bone_; }
  const Landmarks& landmarks() const { return landmarks_; }

 private:
  std::unique_ptr<BoneShape> bone_;
  Landmarks landmarks_;
};

inline double box_distance_mm(const Vec3& p, const Vec3& centre, const Vec3& half) {
  const Vec3 q = (p - centre).cwiseAbs() - half;
  return q.cwiseMax(0.0).norm() + std::min(0.0, q.maxCoeff());
}

inline double capsule_distance_mm(const Vec3& p, const Vec3& a, const Vec3& b, double radius) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm() - radius;
}

/// A block of bone with a round hole along z for a canal.
class Block : public FormulaBone {
 public:
  static constexpr double kHalfWidthMm = 30.0;   ///< x
  static constexpr double kHalfDepthMm = 20.0;   ///< y
  static constexpr double kHalfHeightMm = 18.0;  ///< z
  static constexpr double kHoleMm = 8.0;         ///< radius
  static constexpr double kPedicleMm = 18.0;     ///< |x| of the pedicles

  Block() : FormulaBone(value_mm, Box3(-half(), half()), kHoleMm, kPedicleMm) {}

  static Vec3 half() { return Vec3(kHalfWidthMm, kHalfDepthMm, kHalfHeightMm); }
  static double value_mm(const Vec3& p) {
    return std::max(box_distance_mm(p, Vec3::Zero(), half()), kHoleMm - std::hypot(p.x(), p.y()));
  }
};

/// Whether a place of the phantom's surface belongs to the canal's wall: it faces the canal's middle from near by.
inline bool faces_canal(const Vertebra& vertebra, const Vec3& p_mm, const Vec3& normal) {
  const Vec3 own = vertebra.to_own(p_mm);
  if (std::abs(own.x()) > 14.0 || own.y() < 12.0 || own.y() > 33.0 || std::abs(own.z()) > 15.0) return false;
  const Vec3 to_middle = Vec3(0.0, 21.5, own.z()) - own;
  return Vec3(vertebra.rotation().transpose() * normal).dot(to_middle) > 0.3 * to_middle.norm();
}

/// The phantom's landmarks as far as grading needs them, from what is known of it.
inline Landmarks phantom_landmarks(const Vertebra& vertebra, const BoneShape& bone) {
  const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra);
  Landmarks landmarks;
  landmarks.axes = vertebra.rotation();
  landmarks.origin_mm = vertebra.to_patient(Vec3(0.0, 21.5, 0.0));
  const auto pedicle = [](const PedicleGroundTruth& known) {
    return PedicleLandmarks{known.isthmus_mm,  known.axis,     known.width_axis,
                            known.height_axis, known.width_mm, known.height_mm};
  };
  landmarks.left_pedicle = pedicle(ground_truth.left);
  landmarks.right_pedicle = pedicle(ground_truth.right);
  for (std::size_t n = 0; n < bone.points_mm().size(); ++n) {
    landmarks.is_canal_wall.push_back(faces_canal(vertebra, bone.points_mm()[n], bone.normals()[n]) ? 1 : 0);
  }
  return landmarks;
}

/// The phantom, its surface as a BoneShape, and its landmarks.
struct PhantomBone {
  explicit PhantomBone(const VertebraAnatomy& anatomy = {})
      : vertebra(std::make_shared<Vertebra>(anatomy)),
        bone(std::make_shared<GriddedField>(*vertebra), vertebra->bounds_mm(), 0.3),
        landmarks(phantom_landmarks(*vertebra, bone)) {}

  std::shared_ptr<const Vertebra> vertebra;
  BoneShape bone;
  Landmarks landmarks;
};

}  // namespace spinaltap::test
