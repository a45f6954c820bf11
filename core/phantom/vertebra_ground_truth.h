#pragma once

#include "core/phantom/vertebra.h"

namespace spinaltap {

/// What is known of one pedicle without measuring. Points and directions in patient LPS, after placement.
struct PedicleGroundTruth {
  Vec3 isthmus_mm = Vec3::Zero();    ///< centre of the narrowest section, an exact ellipse
  Vec3 axis = -Vec3::UnitY();        ///< unit, from the back to the front
  Vec3 width_axis = Vec3::UnitX();   ///< unit, along the ellipse's small diameter
  Vec3 height_axis = Vec3::UnitZ();  ///< unit, along its large one
  double width_mm = 0.0;
  double height_mm = 0.0;
  /// A path along the axis: from where it leaves the bone's back to 8 mm short of where it leaves the body's front.
  Vec3 entry_mm = Vec3::Zero();
  Vec3 target_mm = Vec3::Zero();
};

struct VertebraGroundTruth {
  PedicleGroundTruth left;  ///< the patient's left, +x in the vertebra's own frame
  PedicleGroundTruth right;
};

/// Works out the ground truth; the entry lies on the surface within 1e-9 mm. Throws Error when an axis misses the body.
VertebraGroundTruth vertebra_ground_truth(const Vertebra& vertebra);

}  // namespace spinaltap
