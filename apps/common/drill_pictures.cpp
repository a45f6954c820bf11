#include "apps/common/drill_pictures.h"

#include "apps/common/picture_view.h"
#include "vdb/render.h"
#include "vdb/subtract_bit.h"

namespace spinaltap {

std::vector<ReportPicture> drill_pictures(const BoneModel& bone, const BoneModel& drilled, const DrillPath& path,
                                          const Progress& progress) {
  RenderOptions behind;
  behind.from = Vec3(0.0, 1.0, 0.3);
  behind.uncut = &bone;
  const auto seen = [&](const PictureView& view) {
    RenderOptions options = behind;
    options.from = view.from;
    options.up = view.up;
    return options;
  };
  const RenderOptions oblique = seen(view_of_hole(path, bone));
  const PictureCut along = cut_along_path(path);
  const BoneModel opened = cut_by_plane(drilled, along.point_mm, along.normal);
  const RenderOptions from_below = seen(view_onto(along));
  const PictureCut upright = upright_cut(path, bone);
  const BoneModel opened_side = cut_by_plane(drilled, upright.point_mm, upright.normal);
  const RenderOptions from_side = seen(view_onto(upright));

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
