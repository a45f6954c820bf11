#pragma once

#include <string>
#include <vector>

#include "apps/report/html_report.h"
#include "apps/report/slice_frame.h"
#include "core/ct/ct_volume.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// How a CT slice with a drill path is drawn.
struct SliceFigureOptions {
  double width_units = 540.0;  ///< of the drawing; the text is 14 units high
  double scale_bar_mm = 10.0;
};

/// An <svg> element (for a place in an HTML page): the slice as an embedded PNG, and over it the bit at the path's
/// target. Solid and filled is the bit's section with the plane at its true width, dashed its projection; both are one
/// where the plane holds the path. With the axis, entry, target, orientation letters and a scale bar. No external
/// references. `description` is for screen readers. Throws Error on an empty slice.
std::string slice_svg(const CtSlice& slice, const DrillPath& path, const std::string& description,
                      const SliceFigureOptions& options = {});

/// "Axial, z = 12.3 mm": the plane's name and its position (mm, patient LPS) in the direction across it.
std::string plane_caption(Plane plane, const SliceFrame& frame);

/// "Along the path, 12.0° from axial": how far path_frame() had to tilt.
std::string path_caption(const SliceFrame& frame);

/// Four slices of a CT through the middle of a path, with the path's bit drawn: along the path, axial, sagittal and
/// coronal, all at one scale, the two side by side of one height. They show the bone, whose box is given (patient LPS,
/// mm; empty: a box around the path), and the path.
std::vector<ReportDrawing> path_slices(const CtVolume& ct, const DrillPath& path, const Box3& bone_bounds_mm);

}  // namespace spinaltap
