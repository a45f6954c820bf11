#pragma once

#include <string>
#include <vector>

#include "apps/report/html_report.h"
#include "core/base/progress.h"
#include "core/tool/drill_path.h"
#include "vdb/grid/bone_model.h"
#include "vdb/picture/render.h"

namespace spinaltap {

/// From where a picture looks.
struct PictureView {
  Vec3 from = Vec3::UnitY();  ///< patient LPS, from the bone to the eye
  Vec3 up = Vec3::UnitZ();
};

/// From the hole's side, a little above it: straight down the path the hole would hide its own wall.
PictureView view_of_hole(const DrillPath& path, const BoneModel& bone);
/// Holds the path and is as near to a transaxial plane as that allows; takes away what lies below.
CutPlane cut_along_path(const DrillPath& path);
/// Stands upright along the path; takes away what lies beside it, away from the middle.
CutPlane upright_cut(const DrillPath& path, const BoneModel& bone);
/// Straight onto a cut. From below the patient's front is up, as on transaxial slices.
PictureView view_onto(const CutPlane& cut);

/// "behind", "front", "left", "right" (of the patient), "above", "below", "hole" (needs a path; else null), or the
/// direction to the eye as "x,y,z". Throws Error on other names.
PictureView named_view(const std::string& name, const DrillPath* path, const BoneModel& bone);
/// "axial", "sagittal", "coronal": through the path's middle, or the bone's without one; "path" and "upright": see
/// above. Throws Error on other names, and where there is no path.
CutPlane named_cut(const std::string& name, const DrillPath* path, const BoneModel& bone);

/// The bone, half transparent, with the paths' screws or bits in place: from behind, the left, the right and above.
std::vector<ReportPicture> planned_pictures(const BoneModel& bone, const std::vector<DrillPath>& paths,
                                            const Progress& progress = {});

/// The bone before and after drilling, from behind and from the side of the hole, then cut open along the path in two
/// planes.
std::vector<ReportPicture> drill_pictures(const BoneModel& bone, const BoneModel& drilled, const DrillPath& path,
                                          const Progress& progress = {});

}  // namespace spinaltap
