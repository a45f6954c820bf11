#include "core/registration/registered_probabilities.h"

#include <algorithm>

#include "core/anatomy/wall_distance.h"
#include "core/base/error.h"
#include "core/base/quasi_random.h"
#include "core/registration/rigid_pose.h"
#include "core/tool/plate.h"

namespace spinaltap {
namespace {

/// Of the sequence of which the screw's own error has the first.
constexpr int kFirstDimension = 6;

void check_registration(const PoseCovariance& registration, const DrillPath& path) {
  constexpr double kFurthestMm = 100.0;
  check_covariance(registration);
  const double worst_mm =
      std::max(target_error_mm(registration, path.entry_mm), target_error_mm(registration, path.target_mm));
  if (!(worst_mm <= kFurthestMm)) {
    fail("probabilities of grades: expected a registration that errs by up to ", kFurthestMm, " mm at the path, found ",
         worst_mm, " mm");
  }
}

PoseError drawn_pose_error(const PoseCovariance& registration, std::uint64_t seed, std::uint32_t index) {
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();
  for (int n = 0; n < 3; ++n) {
    a[n] = sobol_normal(seed, index, kFirstDimension + n);
    b[n] = sobol_normal(seed, index, kFirstDimension + 3 + n);
  }
  return pose_error_of(registration, a, b);
}

}  // namespace

DrillPath misregistered(const DrillPath& path, const PoseError& error, const Vec3& centre_mm) {
  const RigidPose motion = small_motion(error.turn_rad, error.shift_mm, centre_mm);
  DrillPath moved = path;
  moved.entry_mm = motion.apply(path.entry_mm);
  moved.target_mm = motion.apply(path.target_mm);
  for (Vec3& via_mm : moved.via_mm) via_mm = motion.apply(via_mm);
  return moved;
}

GradeProbabilities registered_probabilities(const WallDistance& walls, const DrillPath& path,
                                            const PlacementErrors& errors, const PoseCovariance& registration,
                                            const ProbabilityOptions& options, const Progress& progress) {
  check_errors(errors);
  check_path(path);
  check_turns(path.bit, "errors of placement");
  check_registration(registration, path);
  breach_mm(walls, path, options.grade);  // rejects options without sense
  const ErrorFrame frame = error_frame(walls.landmarks(), path);
  return grade_probabilities(
      walls,
      [&](std::uint32_t index) {
        const DrillPath erred = erred_path(path, frame, draw_error(errors, options.seed, index));
        return misregistered(erred, drawn_pose_error(registration, options.seed, index), registration.centre_mm);
      },
      options, progress);
}

}  // namespace spinaltap
