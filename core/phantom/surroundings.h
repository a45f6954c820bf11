#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap {

class Spine;

/// What a body lies in, as a CT number of every place.
class Surroundings {
 public:
  virtual ~Surroundings() = default;
  /// HU at p, patient LPS, mm. May be asked from many threads.
  virtual double hu(const Vec3& p_patient) const = 0;
};

struct SoftTissueOptions {
  double muscle_hu = 55.0;
  double fat_hu = -100.0;
  double disc_hu = 90.0;
  double canal_hu = 30.0;
  double aorta_hu = 220.0;  ///< with contrast
  double lung_hu = -850.0;
  double skin_mm = 45.0;   ///< from the tips of the spinous processes to the air behind the patient
  std::uint64_t seed = 1;  ///< of the patches of fat
};

/// Soft tissue around a spine: discs, the canal's contents, muscle with patches and layers of fat, the aorta in front
/// of the column to its left, lungs beside thoracic bodies, air behind the skin. A neck has its own outline and a
/// windpipe, and no aorta. Drawn after textbooks; borders are as soft as a scan's.
class SoftTissue : public Surroundings {
 public:
  /// `spine`: made from SpineOptions; throws Error for any other.
  explicit SoftTissue(const Spine& spine, const SoftTissueOptions& options = {});

  double hu(const Vec3& p_patient) const override;

  /// A place along the column: a body's or a disc's middle.
  struct Station {
    Vec3 centre_mm;
    Mat3 rotation;
    double half_width_mm, half_depth_mm;
    double canal_half_width_mm, canal_half_depth_mm, canal_y_mm;  ///< in the station's frame
    double back_mm;                                               ///< y of the spinous processes' tips
    double lung;                                                  ///< 1 beside the lungs, 0 below them
    double neck;                                                  ///< 1 in the neck, 0 below it
  };
  /// The column's place at a height, between those of the bodies above and below.
  Station at_height(double z_mm) const;
  const SoftTissueOptions& options() const { return options_; }

 private:
  /// A disc in its own frame, or a head.
  struct Disc {
    Vec3 centre_mm;
    Mat3 rotation;
    double half_width_mm, half_depth_mm, half_height_mm;
  };

  double in_neck_hu(double hu, const Vec3& p, const Station& here) const;

  std::vector<Station> stations_;  ///< from above
  std::vector<Disc> discs_;
  std::optional<Disc> head_;  ///< the braincase with its scalp
  SoftTissueOptions options_;
};

}  // namespace spinaltap
