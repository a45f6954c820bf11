#include "core/registration/calibrate_pivot.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {
namespace {

using NormalMatrix = Eigen::Matrix<double, 6, 6>;

/// Of the weakest direction in the tool: the half angle of an even cone whose axis it is, and that moves its end alike.
double cone_of_poses_deg(std::span<const RigidPose> poses) {
  Mat3 mean = Mat3::Zero();
  for (const RigidPose& pose : poses) mean += pose.rotation;
  mean /= static_cast<double>(poses.size());
  Mat3 spread = Mat3::Zero();
  for (const RigidPose& pose : poses) spread += (pose.rotation - mean).transpose() * (pose.rotation - mean);
  spread /= static_cast<double>(poses.size());
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(spread, Eigen::EigenvaluesOnly);
  return std::asin(std::sqrt(std::clamp(solver.eigenvalues()[0], 0.0, 1.0))) / kDegree;
}

}  // namespace

PivotCalibration calibrate_pivot(std::span<const RigidPose> tool_in_tracker, const PivotOptions& options) {
  constexpr std::size_t kFewest = 6;
  constexpr std::size_t kMost = 10'000'000;
  if (tool_in_tracker.size() < kFewest || tool_in_tracker.size() > kMost) {
    fail("pivot calibration: expected ", kFewest, " to ", kMost, " poses, found ", tool_in_tracker.size());
  }
  if (!(options.min_cone_deg > 0.0 && options.min_cone_deg < 90.0) || !(options.max_tip_mm > 0.0)) {
    fail("pivot calibration: expected a smallest cone of 0 to 90 degrees and a largest error above 0 mm, found ",
         options.min_cone_deg, " and ", options.max_tip_mm);
  }
  std::vector<RigidPose> poses;
  poses.reserve(tool_in_tracker.size());
  for (std::size_t n = 0; n < tool_in_tracker.size(); ++n) {
    poses.push_back(checked_pose(tool_in_tracker[n], joined("pose ", n + 1)));
  }
  PivotCalibration found;
  found.cone_deg = cone_of_poses_deg(poses);
  if (!(found.cone_deg >= options.min_cone_deg)) {
    fail("pivot calibration: expected the tool to be turned through a cone of ", options.min_cone_deg,
         " degrees or more to each side, found ", fixed_text(found.cone_deg, 1),
         ": turn it further while its tip stands still");
  }
  // About the positions' middle, so that a tracker far away costs no digits.
  Vec3 middle_mm = Vec3::Zero();
  for (const RigidPose& pose : poses) middle_mm += pose.translation_mm / static_cast<double>(poses.size());
  NormalMatrix normal = NormalMatrix::Zero();
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  for (const RigidPose& pose : poses) {
    Eigen::Matrix<double, 3, 6> row;
    row.leftCols<3>() = pose.rotation;
    row.rightCols<3>() = -Mat3::Identity();
    normal += row.transpose() * row;
    right -= row.transpose() * (pose.translation_mm - middle_mm);
  }
  const Eigen::Matrix<double, 6, 1> solution = normal.ldlt().solve(right);
  found.tip_mm = solution.head<3>();
  found.pivot_mm = solution.tail<3>() + middle_mm;
  const Eigen::SelfAdjointEigenSolver<NormalMatrix> solver(normal, Eigen::EigenvaluesOnly);
  found.condition = std::sqrt(solver.eigenvalues()[5] / solver.eigenvalues()[0]);
  double squares_mm2 = 0.0;
  for (const RigidPose& pose : poses) {
    found.residuals_mm.push_back((pose.apply(found.tip_mm) - found.pivot_mm).norm());
    squares_mm2 += found.residuals_mm.back() * found.residuals_mm.back();
  }
  const double count = static_cast<double>(poses.size());
  found.residual_rms_mm = std::sqrt(squares_mm2 / count);
  const NormalMatrix inverse = normal.inverse();
  found.tip_covariance_mm2 = squares_mm2 / (3.0 * count - 6.0) * inverse.topLeftCorner<3, 3>();

  const Eigen::SelfAdjointEigenSolver<Mat3> tip(found.tip_covariance_mm2, Eigen::EigenvaluesOnly);
  const double worst_mm = std::sqrt(std::max(0.0, tip.eigenvalues()[2]));
  if (worst_mm > options.max_tip_mm) {
    found.warnings.push_back(joined("the tip is known to ", fixed_text(worst_mm, 2),
                                    " mm only along its worst direction: turn the tool through a wider cone"));
  }
  std::vector<double> sorted = found.residuals_mm;
  std::sort(sorted.begin(), sorted.end());
  const double median_mm = sorted[sorted.size() / 2];
  // The median of a residual's length is 1.54 deviations (chi of 3 degrees); 6 deviations are met by none of 10^7.
  constexpr double kSlipped = 6.0 / 1.54;
  constexpr double kLeastMm = 0.05;
  const auto slipped = std::count_if(sorted.begin(), sorted.end(), [&](double residual_mm) {
    return residual_mm > kSlipped * std::max(median_mm, kLeastMm);
  });
  if (slipped > 0) {
    found.warnings.push_back(joined("the tip moved: ", slipped, " of ", poses.size(), " poses put it up to ",
                                    fixed_text(sorted.back(), 2), " mm from the dimple, half of them less than ",
                                    fixed_text(median_mm, 2), " mm"));
  }
  return found;
}

}  // namespace spinaltap
