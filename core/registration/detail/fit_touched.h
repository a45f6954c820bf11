#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/anatomy/bone_shape.h"
#include "core/registration/pose_covariance.h"
#include "core/registration/rigid_pose.h"

namespace spinaltap::detail {

/// A pose of the touched points and how well it fits.
struct FittedPose {
  RigidPose pose;
  double cost = 0.0;  ///< mean square distance, mm², each capped
  std::vector<double> residuals_mm;
  std::vector<std::uint8_t> is_kept;
};

/// Steps of one round of the search: weights narrow from one scale to the other.
struct CoarseRound {
  int steps;
  double from_mm, to_mm;
};
inline constexpr CoarseRound kFirstRound{8, 12.0, 3.0};
inline constexpr CoarseRound kSecondRound{15, 3.0, 1.0};

/// Fits touched points to a bone's surface, from poses that are given. Any thread may ask.
class TouchedFit {
 public:
  TouchedFit(const BoneShape& bone, std::span<const Vec3> touched_mm);

  /// On a thinned surface: nearest points only.
  FittedPose coarse(const RigidPose& start, const CoarseRound& round) const;
  /// On the surface itself, to the end.
  FittedPose fine(const RigidPose& start, double told_noise_mm) const;
  /// Of the points kept, each with noise of `noise_mm` along its normal; what they do not hold at all is as far off as
  /// the search goes.
  PoseCovariance covariance(const FittedPose& fit, double noise_mm, double search_mm, double search_deg) const;

 private:
  struct Foot {
    double distance_mm;  ///< signed
    Vec3 normal;         ///< along which it grows, unit
  };
  void find_feet(const RigidPose& pose, std::vector<Vec3>& places_mm, std::vector<Foot>& feet) const;

  const BoneShape& bone_;
  std::vector<Vec3> touched_mm_;
  PointTree thinned_;
};

}  // namespace spinaltap::detail
