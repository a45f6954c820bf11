#pragma once

#include <vector>

#include "apps/report/html_report.h"
#include "core/ct/ct_volume.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// Four slices of a CT through the middle of a path, with the path's bit drawn: along the path, axial, sagittal and
/// coronal, all at one scale, the two side by side of one height. They show the bone, whose box is given (patient LPS,
/// mm; empty: a box around the path), and the path.
std::vector<ReportDrawing> path_slices(const CtVolume& ct, const DrillPath& path, const Box3& bone_bounds_mm);

}  // namespace spinaltap
