#pragma once

#include <limits>
#include <string>
#include <vector>

#include "apps/report/bone_outline.h"
#include "apps/report/html_report.h"
#include "apps/report/slice_frame.h"
#include "core/anatomy/landmarks.h"
#include "core/ct/ct_volume.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// How a CT slice with a drill path is drawn.
struct SliceFigureOptions {
  double width_units = 540.0;  ///< of the drawing; the text is 14 units high
  double scale_bar_mm = 10.0;
};

/// A length that a slice tells, with a line that has ends.
struct SliceMeasure {
  Vec3 from_mm = Vec3::Zero();  ///< patient LPS
  Vec3 to_mm = Vec3::Zero();    ///< patient LPS
  std::string text;
};

/// What is drawn over a CT slice.
struct SliceScene {
  DrillPath path;                      ///< with its tool at the target: its screw, head and all, or else its bit
  std::vector<DrillPath> others = {};  ///< further tools, of which only the outlines are drawn
  const OutlinedBone* bone = nullptr;  ///< none: no outline
  /// From this depth on what the tool's section has beyond the bone is red; NaN: nothing is.
  double red_from_mm = std::numeric_limits<double>::quiet_NaN();
  bool names_ends = true;  ///< marks and names entry and target
  std::vector<SliceMeasure> measures = {};
};

/// An <svg> element (for a place in an HTML page): the slice as an embedded PNG, and over it the bone's outline, the
/// canal's wall in a colour of its own, and the tool. Solid and filled is the tool's section with the plane at its true
/// width, dashed its projection; both are one where the plane holds the path. Where the plane is across the path, the
/// projection is that of the thread or shaft alone. With the axis, entry, target, orientation letters and a scale bar.
/// No external references. `description` is for screen readers. Throws Error on an empty slice.
std::string slice_svg(const CtSlice& slice, const SliceScene& scene, const std::string& description,
                      const SliceFigureOptions& options = {});

/// "Axial, z = 12.3 mm": the plane's name and its position (mm, patient LPS) in the direction across it.
std::string plane_caption(Plane plane, const SliceFrame& frame);

/// "Along the path, 12.0° from axial": how far path_frame() had to tilt.
std::string path_caption(const SliceFrame& frame);

/// Four slices of a CT through the middle of a path, with what the scene has: along the path, axial, sagittal and
/// coronal, all at one scale, the two side by side of one height. They show the bone, whose box is given (patient LPS,
/// mm; empty: a box around the path), and the path.
std::vector<ReportDrawing> path_slices(const CtVolume& ct, const SliceScene& scene, const Box3& bone_bounds_mm);

/// The plane at right angles to the path at a depth, seen along it as from behind, so many mm wide and high.
SliceFrame cross_frame(const DrillPath& path, double depth_mm, const Eigen::Vector2d& size_mm, double pixel_mm = 0.1);

/// Slices for a page with two paths beside each other: axial and along the path of one size, sagittal of that width,
/// and across the path, of half of it, at `isthmus_mm` along it and at its tip.
std::vector<ReportDrawing> page_slices(const CtVolume& ct, const SliceScene& scene, const Box3& bone_bounds_mm,
                                       double isthmus_mm);

/// The isthmus of a pedicle, across it, with its width and the screw of the scene along its axis; and the axial slice
/// there, both of half a column's width.
std::vector<ReportDrawing> isthmus_slices(const CtVolume& ct, SliceScene scene, const Box3& bone_bounds_mm,
                                          const PedicleLandmarks& pedicle);

}  // namespace spinaltap
