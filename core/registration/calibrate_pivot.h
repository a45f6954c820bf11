#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/registration/rigid_pose.h"

namespace spinaltap {

struct PivotOptions {
  double min_cone_deg = 10.0;  ///< half angle of the cone that the tool was turned through; below it is an error
  double max_tip_mm = 1.0;     ///< a tip that is known worse, one deviation along its worst direction, is warned of
};

/// Where a tracked tool's tip is, from poses while the tip stood still in a dimple.
struct PivotCalibration {
  Vec3 tip_mm = Vec3::Zero();        ///< in the tool's own frame
  Vec3 pivot_mm = Vec3::Zero();      ///< the dimple, in the tracker's
  std::vector<double> residuals_mm;  ///< of each pose: how far it puts the tip from the dimple
  double residual_rms_mm = 0.0;
  Mat3 tip_covariance_mm2 = Mat3::Zero();
  double cone_deg = 0.0;   ///< half angle of the cone that would hold the tip as badly as these poses do
  double condition = 0.0;  ///< of the equations: largest over smallest singular value
  std::vector<std::string> warnings;
};

/// Least squares of R t + p = w over all poses (R, p) of the tool in the tracker's frame: the algebraic one-step method
/// of Yaniv, "Which pivot calibration?", Proc. SPIE 9415, 2015. Throws Error on fewer than 6 poses, on what is not
/// finite, and on poses that turn through less than the smallest cone: they hold no tip.
PivotCalibration calibrate_pivot(std::span<const RigidPose> tool_in_tracker, const PivotOptions& options = {});

}  // namespace spinaltap
