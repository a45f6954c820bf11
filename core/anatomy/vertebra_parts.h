#pragma once

#include <array>

#include "core/anatomy/landmarks.h"
#include "core/base/geometry.h"

namespace spinaltap {

class BoneShape;

/// Names places of a vertebra's surface by where they lie in its own frame. The borders between its parts are
/// conventions: a few millimetres to either side a person may say otherwise. The joint surfaces are known to about 2
/// mm.
class VertebraParts {
 public:
  /// Keeps a reference to the landmarks.
  VertebraParts(const BoneShape& bone, const Landmarks& landmarks);

  /// The part that a place of the surface belongs to; `normal`: there, unit, outward.
  VertebraPart at(const Vec3& p_mm, const Vec3& normal) const;
  /// Whether the place lies on the superior articular process' joint surface: within kJointMm of the process' tip,
  /// above the pedicle's middle, and facing backwards or towards the middle as facets do.
  bool is_joint(const Vec3& p_mm, const Vec3& normal) const;

  /// How far below its tip a superior articular process carries cartilage. Published heights of superior facets are 10
  /// to 12 mm in the thoracic and 12 to 17 mm in the lumbar spine, of which the lowest part lies on the process' base.
  static constexpr double kJointMm = 11.0;

 private:
  const Landmarks& landmarks_;
  std::array<Vec3, 2> tips_mm_{};  ///< of the superior articular processes, own frame: left, right
  std::array<bool, 2> has_tip_{};
};

}  // namespace spinaltap
