#include "core/tool/path_frame.h"

#include "core/base/error.h"

namespace spinaltap {

PathFrame::PathFrame(const Vec3& origin_mm, const Vec3& direction) : origin_mm_(origin_mm) {
  if (!(direction.norm() > 0.0) || !direction.allFinite() || !origin_mm.allFinite()) {
    fail("path frame: expected a finite origin and a direction that is not zero");
  }
  const Vec3 z = direction.normalized();
  const Vec3 x = any_perpendicular(z);
  rotation_.col(0) = x;
  rotation_.col(1) = z.cross(x);
  rotation_.col(2) = z;
}

}  // namespace spinaltap
