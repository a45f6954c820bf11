#pragma once

#include <array>

#include "core/anatomy/bone_shape.h"

namespace spinaltap {

/// The plane section of a bone around one place of it, as radii at even angles from its centroid.
struct BoneSection {
  static constexpr std::size_t kRays = 64;
  static constexpr double kMaxRadiusMm = 18.0;  ///< where the section goes on further, it is cut here

  Vec3 centre_mm = Vec3::Zero();
  Vec3 u = Vec3::UnitX(), v = Vec3::UnitZ();  ///< unit, spanning the plane; angles run from u to v
  std::array<double, kRays> radii_mm{};
  double area_mm2 = 0.0;
  int endless = 0;      ///< rays that were cut
  bool inside = false;  ///< whether the centre lies in the bone; without, nothing else is set

  Vec3 direction(std::size_t ray) const;
};

/// The section around `p_mm` at right angles to `normal`, moved to its own centroid. `upward` is made v.
BoneSection section_around(const BoneShape& bone, const Vec3& p_mm, const Vec3& normal, const Vec3& upward);

/// The same section with its contour on the surface itself instead of the lattice's.
BoneSection sharpened(const BoneShape& bone, BoneSection section);

/// A section's principal axes and its extents along them.
struct SectionSize {
  Vec3 small_axis = Vec3::UnitX(), large_axis = Vec3::UnitZ();  ///< unit; signs so that they go along u and v
  double small_mm = 0.0, large_mm = 0.0;
};

/// Axes from the second moments. Extents of the contour after it was smoothed: of the ratio of its radii to those of
/// the ellipse with its moments the Fourier orders up to 5 are kept. That changes no ellipse, and leaves out most of a
/// surface's noise, which would make every extent too large.
SectionSize size_of(const BoneSection& section);

}  // namespace spinaltap
