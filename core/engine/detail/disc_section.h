#pragma once

#include <algorithm>
#include <cmath>

#include "core/tool/swept_bit.h"

namespace spinaltap {

/// Where a bit's axis meets the plane of a disc, and how far around the swept bit can reach there.
struct DiscSection {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double reach_mm = 0.0;  ///< from (x, y) in the plane; infinite where the axis lies nearly in the plane

  /// Within `out_of_plane_mm` of the plane at z. A bit's section with a plane is an ellipse, or less, that is longer
  /// than its radius by the tilt.
  DiscSection(const SweptBit& bit, double z_mm, double out_of_plane_mm) {
    const Pose& pose = bit.to();
    const double along = std::abs(pose.axis.z());
    if (along < 1e-3) {
      reach_mm = HUGE_VAL;
      return;
    }
    const double to_plane_mm = (z_mm - pose.tip_mm.z()) / pose.axis.z();
    x_mm = pose.tip_mm.x() + to_plane_mm * pose.axis.x();
    y_mm = pose.tip_mm.y() + to_plane_mm * pose.axis.y();
    reach_mm = (bit.profile().radius_mm() + bit.across_mm() + out_of_plane_mm) / along + 1e-4;
  }
};

}  // namespace spinaltap
