#include "apps/common/drill_pictures.h"

#include "vdb/render.h"
#include "vdb/subtract_bit.h"

namespace spinaltap {

std::vector<ReportPicture> drill_pictures(const BoneModel& bone, const BoneModel& drilled, const DrillPath& path,
                                          const Progress& progress) {
  const Vec3 along = path.direction();
  RenderOptions behind;
  behind.from = Vec3(0.0, 1.0, 0.3);
  behind.uncut = &bone;
  // From the hole's side, a little above it: straight down the path the hole would hide its own wall.
  RenderOptions oblique = behind;
  const double side = path.entry_mm.x() >= bone.bounds_mm().center().x() ? 1.0 : -1.0;
  oblique.from = -along + side * 0.45 * Vec3::UnitX() + 0.25 * Vec3::UnitZ();
  // The cut holds the path and is as near to a transaxial plane as that allows. What lies below it is taken away, and
  // the eye looks up from the feet, as on transaxial slices: the patient's left is on the right.
  const Vec3 cut_normal = (Vec3::UnitZ() - Vec3::UnitZ().dot(along) * along).normalized();
  RenderOptions from_below = behind;
  from_below.from = -cut_normal;
  from_below.up = -Vec3::UnitY();
  const BoneModel opened = cut_by_plane(drilled, path.entry_mm, -cut_normal);
  // The other cut stands upright along the path; what lies beside it, away from the middle, is taken away.
  Vec3 side_normal = along.cross(cut_normal).normalized();
  if (side_normal.x() * side < 0.0) side_normal = -side_normal;
  RenderOptions from_side = behind;
  from_side.from = side_normal;
  const BoneModel opened_side = cut_by_plane(drilled, path.entry_mm, side_normal);

  std::vector<ReportPicture> pictures;
  pictures.push_back({render_bone(bone, behind, progress), "Before, from behind"});
  pictures.push_back({render_bone(drilled, behind, progress), "After, from behind"});
  pictures.push_back({render_bone(bone, oblique, progress), "Before, from the side of the hole"});
  pictures.push_back({render_bone(drilled, oblique, progress), "After, from the side of the hole"});
  pictures.push_back(
      {render_bone(opened, from_below, progress),
       "After, cut open along the path and seen from the feet, as on the axial slice: marrow red, cortex "
       "white, by CT number"});
  pictures.push_back({render_bone(opened_side, from_side, progress),
                      "After, cut upright along the path and seen from the side of the hole"});
  return pictures;
}

}  // namespace spinaltap
