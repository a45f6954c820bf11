#pragma once

#include <memory>

#include "core/phantom/solid.h"
#include "core/phantom/vertebra_anatomy.h"

namespace spinaltap {

/// A vertebra (an L3 by default) in closed form, placed in the patient frame: analytic parts joined by smooth minima,
/// with a cortical shell and a textured trabecular core. One piece with one hole, the vertebral canal.
class Vertebra : public Solid {
 public:
  /// Throws Error when check_anatomy() does, or when a fillet or the canal reaches the isthmus of the pedicle, so that
  /// its size would no longer be what the anatomy says.
  explicit Vertebra(const VertebraAnatomy& anatomy = {});
  ~Vertebra() override;
  Vertebra(const Vertebra&) = delete;
  Vertebra& operator=(const Vertebra&) = delete;

  /// Near the surface (0.5 mm outside, 0.35 mm inside, more where no fillet is near) the value is the distance, 4% a mm
  /// smaller; further away it goes over into a smaller bound. Gradients are central differences.
  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3> gradients) const override;
  Box3 bounds_mm() const override;
  double hu(const Vec3& p_patient, double distance_mm, double aperture_mm) const override;

  const VertebraAnatomy& anatomy() const { return anatomy_; }
  /// From the vertebra's own frame to patient LPS, and directions likewise.
  Vec3 to_patient(const Vec3& p_own) const;
  Vec3 to_own(const Vec3& p_patient) const;
  const Mat3& rotation() const { return rotation_; }

 private:
  struct Inside;

  double value_mm(const Vec3& p_own) const;

  VertebraAnatomy anatomy_;
  Mat3 rotation_;
  std::unique_ptr<const Inside> inside_;
};

}  // namespace spinaltap
