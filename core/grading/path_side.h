#pragma once

#include "core/anatomy/landmarks.h"
#include "core/anatomy/wall_distance.h"
#include "core/base/geometry.h"
#include "core/grading/path_findings.h"
#include "core/tool/path_curve.h"

namespace spinaltap {

/// Names sides as seen from one path, in the vertebra's own frame.
class SideNames {
 public:
  SideNames(const Landmarks& landmarks, const DrillPath& path);

  /// The pedicle whose isthmus is nearer to the path.
  const PedicleLandmarks& pedicle() const { return *pedicle_; }
  bool is_left() const { return pedicle_ == &landmarks_.left_pedicle; }

  /// Unit, from a place on the path's axis towards the wall, or through it where the place is beyond it already. Within
  /// 0.5 mm of the wall, the wall's normal.
  static Vec3 towards(const Vec3& p_mm, const WallDistance::Wall& wall);

  /// The side on which the wall lies that is nearest to p, a place in or on the tool:
  /// - anterior, where the way to it leads forward more than to any other side, or where the wall's normal does; or
  ///   where it lies ahead of the tip and the way to it is within 60 degrees of a path that runs forward;
  /// - else the larger part of the way to it of left or right and up or down. Medial is right of a left pedicle's path
  ///   and left of a right one's, also where it has crossed the middle.
  PathSide of(const Vec3& p_mm, const WallDistance::Wall& wall) const;

 private:
  const Landmarks& landmarks_;
  PathCurve curve_;
  const PedicleLandmarks* pedicle_;
};

}  // namespace spinaltap
