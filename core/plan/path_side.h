#pragma once

#include "core/base/geometry.h"
#include "core/plan/landmarks.h"
#include "core/plan/wall_distance.h"
#include "core/tool/path_curve.h"

namespace spinaltap {

/// How a path is turned, as surgeons say it. Degrees.
struct PathAngles {
  double convergence_deg = 0.0;  ///< towards the midsagittal plane, seen from above; negative: away from it
  double inclination_deg = 0.0;  ///< upward, of the transverse plane; negative: downward
};

/// Of a direction (unit, patient LPS) from the back to the front. `axes`: Landmarks::axes for the vertebra's own
/// planes, the identity for the patient's. `is_left`: of a path on the patient's left.
PathAngles path_angles(const Vec3& direction, const Mat3& axes, bool is_left);

/// Where something lies as seen from a path through a pedicle.
enum class PathSide { medial, lateral, cranial, caudal, anterior };
const char* name_of(PathSide side);

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
