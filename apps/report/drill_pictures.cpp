#include "apps/report/drill_pictures.h"

#include <optional>

#include "apps/report/picture_view.h"
#include "vdb/picture/render.h"

namespace spinaltap {

std::vector<ReportPicture> drill_pictures(const BoneModel& bone, const BoneModel& drilled, const DrillPath& path,
                                          const Progress& progress) {
  const RenderOptions behind{.from = Vec3(0.0, 1.0, 0.3)};
  const auto seen = [](const PictureView& view, const std::optional<CutPlane>& cut) {
    RenderOptions options;
    options.from = view.from;
    options.up = view.up;
    options.cut = cut;
    return options;
  };
  const RenderOptions oblique = seen(view_of_hole(path, bone), {});
  const CutPlane along = cut_along_path(path);
  const CutPlane upright = upright_cut(path, bone);

  std::vector<ReportPicture> pictures;
  pictures.push_back({render_bone(bone, behind, progress), "Before, from behind"});
  pictures.push_back({render_bone(drilled, behind, progress), "After, from behind"});
  pictures.push_back({render_bone(bone, oblique, progress), "Before, from the side of the hole"});
  pictures.push_back({render_bone(drilled, oblique, progress), "After, from the side of the hole"});
  pictures.push_back(
      {render_bone(drilled, seen(view_onto(along), along), progress),
       "After, cut open along the path and seen from the feet, as on the axial slice: marrow red, cortex "
       "white, by CT number"});
  pictures.push_back({render_bone(drilled, seen(view_onto(upright), upright), progress),
                      "After, cut upright along the path and seen from the side of the hole"});
  return pictures;
}

}  // namespace spinaltap
