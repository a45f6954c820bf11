#include "core/session/session_setup.h"

#include "core/base/error.h"
#include "core/tool/path_curve.h"

namespace spinaltap {

Box3 region_around(const DrillPath& path, double lead_in_mm, double margin_mm) {
  constexpr double kMaxMm = 1e4;
  if (!(margin_mm > 0.0 && margin_mm <= kMaxMm)) {
    fail("region: expected a distance from the path above 0 mm and up to 10 m, found ", margin_mm, " mm");
  }
  const PathCurve curve(path);
  Box3 box(curve.at_mm(-lead_in_mm));
  constexpr double kStepMm = 0.25;  // between which a curve bulges by less than 0.02 mm for each 0.5 mm of its radius
  for (const Vec3& p_mm : curve.places_mm(kStepMm)) box.extend(p_mm);
  return {box.min() - Vec3::Constant(margin_mm), box.max() + Vec3::Constant(margin_mm)};
}

void check_region(const Box3& region_mm) {
  const Vec3 &low = region_mm.min(), &high = region_mm.max();
  if (low.allFinite() && high.allFinite() && (low.array() < high.array()).all()) return;
  fail("region: expected a box whose second corner lies beyond its first along each axis, found one from ",
       low.transpose(), " to ", high.transpose(), " mm");
}

}  // namespace spinaltap
