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
  RenderOptions down_the_path = behind;
  // A little from above: straight down the path the hole would hide its own wall.
  down_the_path.from = -along + 0.25 * Vec3::UnitZ() - 0.2 * along.cross(Vec3::UnitZ());
  // The cut holds the path and is as near to a transaxial plane as that allows; what lies above it is taken away.
  const Vec3 cut_normal = (Vec3::UnitZ() - Vec3::UnitZ().dot(along) * along).normalized();
  RenderOptions from_above = behind;
  from_above.from = cut_normal + 0.15 * Vec3::UnitY();
  from_above.up = -Vec3::UnitY();
  const BoneModel opened = cut_by_plane(drilled, path.entry_mm, cut_normal);

  std::vector<ReportPicture> pictures;
  pictures.push_back({render_bone(bone, behind, progress), "Before, from behind"});
  pictures.push_back({render_bone(drilled, behind, progress), "After, from behind"});
  pictures.push_back({render_bone(bone, down_the_path, progress), "Before, along the path"});
  pictures.push_back({render_bone(drilled, down_the_path, progress), "After, along the path"});
  pictures.push_back({render_bone(opened, from_above, progress),
                      "After, cut open along the path, from above; the cut is coloured by CT number, marrow red to "
                      "cortex white. Anterior is up, the patient's left on the right as on the slices' left side."});
  return pictures;
}

}  // namespace spinaltap
