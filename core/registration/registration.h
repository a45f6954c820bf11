#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/ct/bone_identity.h"
#include "core/registration/pose_covariance.h"
#include "core/registration/rigid_pose.h"

namespace spinaltap {

/// Where the patient is: a pose with what is known of its error.
struct Registration {
  enum class Kind : std::uint8_t {
    fiducials,  ///< pairs of marks
    surface     ///< touched points of a bone's surface
  };
  Kind kind = Kind::fiducials;
  RigidPose ct_from_patient;
  PoseCovariance covariance;
  /// Of each point, in their order, mm: of a mark its distance from its pair (the FRE's parts), of a touched point its
  /// signed distance from the surface.
  std::vector<double> residuals_mm;
  std::vector<std::size_t> rejected;  ///< places of touched points that were left out, ascending
  double residual_rms_mm = 0.0;       ///< of those kept: the FRE of marks
  /// Standard deviation of a point to each side that the covariance stands on, mm: told, or found from the residuals.
  double noise_mm = 0.0;
  bool noise_was_told = false;
  /// Why the pose may be wrong, each a sentence; none: nothing speaks against it.
  std::vector<std::string> warnings;
  /// In whose CT it places the patient: of the bone that was touched, or that was given with the marks; empty: not
  /// known.
  BoneIdentity bone = {};
};

/// "fiducials", "surface"
const char* name_of(Registration::Kind kind);

}  // namespace spinaltap
