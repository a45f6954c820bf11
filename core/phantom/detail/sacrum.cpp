#include "core/phantom/detail/sacrum.h"

#include "core/phantom/detail/level_anatomy.h"

namespace spinaltap::shapes {

SacrumShape::SacrumShape(const LevelMeasures& m) {
  const double by = m.body_width_mm / 50.0;
  const double half_height = 0.5 * m.body_height_mm, half_depth = 0.5 * m.body_depth_mm;
  body_ = RoundPlate(Vec3::Zero(), {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()},
                     Vec3(0.5 * m.body_width_mm, half_depth, half_height), 0.35 * half_height);
  wing_ =
      FlatBar(Vec3(16.0, 4.0, -1.0) * by, Vec3(44.0, 12.0, -12.0) * by, Vec3(0.2, 1.0, 0.2), 20.0 * by, 22.0 * by, 1.5);
  lower_ =
      FlatBar(Vec3(0.0, 3.0, -12.0) * by, Vec3(0.0, 32.0, -70.0) * by, Vec3(0.0, 1.0, 0.5), 22.0 * by, 7.0 * by, 2.4);
  const FacetPlace facet = superior_facet(m);
  constexpr double kProcessMm = 7.0;
  const Vec3 tip = facet.centre_mm - 0.5 * kProcessMm * facet.normal;
  process_ = FlatBar(Vec3(tip.x() + 1.0, tip.y() - 1.0, 2.0), tip, facet.normal, 9.0 * by, kProcessMm, 1.5);
  // From the wings' back to the processes, and from these to the crest, around the canal.
  strut_ =
      FlatBar(Vec3(26.0, 10.0, -4.0) * by, Vec3(tip.x() + 1.0, tip.y(), 2.0), Vec3::UnitX(), 9.0 * by, 8.0 * by, 1.5);
  const double back_y = half_depth + m.canal_depth_mm + 4.0;
  back_ =
      FlatBar(Vec3(tip.x() + 1.0, tip.y(), 0.0), Vec3(0.0, back_y + 3.0, -8.0), Vec3::UnitY(), 6.0 * by, 6.0 * by, 2.5);
  crest_ =
      FlatBar(Vec3(0.0, back_y + 4.0, -6.0), Vec3(0.0, back_y + 12.0, -20.0), Vec3::UnitX(), 5.0 * by, 6.0 * by, 2.0);
  for (const Box3& box : {body_.bounds(), wing_.bounds(), lower_.bounds(), back_.bounds(), strut_.bounds(),
                          process_.bounds(), crest_.bounds()}) {
    bounds_.extend(Box3(box.min() - Vec3::Constant(2.0), box.max() + Vec3::Constant(2.0)));
  }
  bounds_.extend(Vec3(-bounds_.max().x(), bounds_.min().y(), bounds_.min().z()));
}

}  // namespace spinaltap::shapes
