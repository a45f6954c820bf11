#pragma once

#include "core/anatomy/wall_distance.h"
#include "core/registration/pose_covariance.h"
#include "core/uncertainty/placement_probabilities.h"

namespace spinaltap {

/// The path where a registration that errs puts it: all its places moved.
DrillPath misregistered(const DrillPath& path, const PoseError& error, const Vec3& centre_mm);

/// How likely each grade is where screws err as a model says and the registration that guides them errs too: the path
/// with the screw's error is moved by the registration's, both drawn anew each time. That is what to expect of the next
/// patient; screws of one patient share one error of registration. Errors of 0 leave the registration's alone. Bit for
/// bit the same at any thread count. Throws Error as grade_probabilities() and check_covariance() do, and on a
/// registration that errs by more than 100 mm, root mean square, where the path is.
GradeProbabilities registered_probabilities(const WallDistance& walls, const DrillPath& path,
                                            const PlacementErrors& errors, const PoseCovariance& registration,
                                            const ProbabilityOptions& options = {}, const Progress& progress = {});

}  // namespace spinaltap
