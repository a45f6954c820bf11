#pragma once

#include <vector>

#include "apps/report/slice_frame.h"
#include "apps/report/slice_marks.h"
#include "core/ct/label_volume.h"

namespace spinaltap {

/// A picture's surface that is straight along its rows and may bend from row to row, as the spine does: row r lies
/// depth_mm[r] behind the plane. Seen at right angles to the plane, so pixels keep its scale.
struct BentFrame {
  SliceFrame plane;
  std::vector<double> depth_mm;  ///< by row, positive away from the viewer

  /// Column, row and depth behind the surface (pixels) of a patient position (mm).
  Vec3 to_pixel(const Vec3& p_patient) const;
  /// Patient position (mm) of a pixel's centre.
  Vec3 to_patient(int column, int row) const;
};

/// The plane of a frame, not bent.
BentFrame flat(const SliceFrame& plane);

/// The plane, bent so that it holds each of `points_mm` (patient LPS), straight from one to the next, and level above
/// the highest and below the lowest. The points may come in any order; of those less than 1 mm apart along the rows'
/// direction the mean is taken. None: not bent.
BentFrame bent_through(const SliceFrame& plane, const std::vector<Vec3>& points_mm);

/// The CT along a bent surface, as ct_slice() has it. Beyond the CT, by half a voxel or more, `outside`.
Image bent_slice(const CtVolume& ct, const BentFrame& frame, const HuWindow& window, const Colour& outside);

/// Which label each pixel's centre lies in, row by row; 0 for none, -1 outside the map.
std::vector<int> labels_on(const LabelVolume& labels, const BentFrame& frame);

}  // namespace spinaltap
