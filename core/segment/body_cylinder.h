#pragma once

#include "core/segment/float_grid.h"

namespace spinaltap {

/// What counts as the outer edge of a bony wall.
struct WallLevels {
  double bone_hu = 150.0;       ///< between soft tissue and bone
  double full_drop_hu = 200.0;  ///< a fall of this much or more is a full wall
};

/// An upright elliptic cylinder: what a vertebral body is like at first sight.
struct BodyCylinder {
  Vec3 centre_mm = Vec3::Zero();          ///< patient LPS
  Vec3 half_mm = Vec3(18.0, 14.0, 12.0);  ///< half the width, depth and height
  Vec3 turn_rad = Vec3::Zero();           ///< about x, then y, then z of the patient
  double fit = 0.0;                       ///< share of a full wall that its surface has on average, up to 1

  /// Whether there is wall enough on it, and it is larger than the search allows at least: what is found around a point
  /// in soft tissue or in an arch is as small as can be, with walls on few sides.
  bool is_body() const;
  /// What a search makes as large as it can. Of two surfaces with as much wall the larger is the whole body, the
  /// smaller a part of it. Height does not count: it would be had from the discs.
  double worth() const;
  /// Columns: the body's own left, back and up in patient LPS.
  Mat3 axes() const;
  /// Below 1 inside the cylinder, above outside: how much larger it would have to be to reach the point.
  double scale_to(const Vec3& p_patient) const;
};

/// How much of a wall's outer edge lies at a point with an outward normal, -1 to 1: the fall of the
/// CT number from just inside to just outside, and only where soft tissue lies outside.
double wall_edge(const FloatGrid& hu, const Vec3& p_patient, const Vec3& outward, const WallLevels& levels);

/// The CT around a point (patient LPS), binned to about 0.8 mm and smoothed as fit_body_cylinder() likes it.
FloatGrid smooth_around(const CtVolume& ct, const Vec3& p_mm);

/// The cylinder around `seed_mm` (patient LPS) with the most wall on its surface, found by a pattern search from many
/// starts. All of its surface speaks at once, so that a wall as thin as the noise is found. Half sizes from 10 x 7.5 x
/// 6.5 mm (the smallest adults' T1) to 32 x 24 x 17.5 mm (the largest L5). `hu` should be smoothed.
/// Its own back is within 20 degrees of the patient's, turned by `facing_rad` about z.
BodyCylinder fit_body_cylinder(const FloatGrid& hu, const Vec3& seed_mm, const WallLevels& levels,
                               double facing_rad = 0.0);

/// The turn about z (rad: 0 or a multiple of a quarter turn) to what is really the body's back, where the arch is: the
/// side with most bone behind it. Other than 0 only where that is twice as much as at the patient's back, as in scans
/// of models that do not lie in the patient's frame.
double facing_of_arch_rad(const FloatGrid& hu, const BodyCylinder& body, double bone_hu);

}  // namespace spinaltap
