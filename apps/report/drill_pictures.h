#pragma once

#include <vector>

#include "apps/report/html_report.h"
#include "core/base/progress.h"
#include "core/tool/drill_path.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// The bone before and after drilling, from behind and from the side of the hole, then cut open along the path in two
/// planes.
std::vector<ReportPicture> drill_pictures(const BoneModel& bone, const BoneModel& drilled, const DrillPath& path,
                                          const Progress& progress = {});

}  // namespace spinaltap
