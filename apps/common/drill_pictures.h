#pragma once

#include <vector>

#include "apps/report/html_report.h"
#include "core/base/progress.h"
#include "core/drill/drill_path.h"
#include "vdb/bone_model.h"

namespace spinaltap {

/// The bone before and after drilling, from behind and along the path, then cut open along the path and seen from above.
std::vector<ReportPicture> drill_pictures(const BoneModel& bone, const BoneModel& drilled, const DrillPath& path,
                                          const Progress& progress = {});

}  // namespace spinaltap
