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

  /// Columns: the body's own left, back and up in patient LPS.
  Mat3 axes() const;
  /// Turns the cylinder so that axes() are these: unit, at right angles, right-handed.
  void set_axes(const Mat3& axes);
  /// Below 1 inside the cylinder, above outside: how much larger it would have to be to reach the point.
  double scale_to(const Vec3& p_patient) const;
};

/// Calls `visit(voxel, place)` for the voxels where `mask` is not 0, one after the other, with their places in the
/// frame of a body: to the left, back and up from its middle, mm.
template <class Visit>
void for_voxels_by_body(std::span<const std::uint8_t> mask, const GridGeometry& geometry, const BodyCylinder& body,
                        const Visit& visit) {
  const Mat3 to_body = body.axes().transpose();
  std::size_t voxel = 0;
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i, ++voxel) {
        if (mask[voxel] != 0) visit(voxel, Vec3(to_body * (geometry.to_patient(Vec3(i, j, k)) - body.centre_mm)));
      }
    }
  }
}

/// Looks for walls in a CT that was smoothed. Keeps a reference to it.
class WallProbe {
 public:
  WallProbe(const FloatGrid& hu, const WallLevels& levels)
      : hu_(hu), levels_(levels), to_index_(hu.geometry.index_to_patient_matrix().inverse()) {}

  /// How much of a wall's outer edge lies at a point with an outward normal, -1 to 1: the fall of the CT number from
  /// just inside to just outside, and only where soft tissue lies outside.
  double edge(const Vec3& p_patient, const Vec3& outward) const;
  /// The CT number, tri-linear; beyond the CT, the border's.
  double hu(const Vec3& p_patient) const;
  const GridGeometry& geometry() const { return hu_.geometry; }

 private:
  const FloatGrid& hu_;
  WallLevels levels_;
  Mat3 to_index_;
};

/// How far refine_body_cylinder() may go from where it starts.
struct RefineLimits {
  double shift_mm = 3.0;      ///< of the middle, across
  double end_shift_mm = 2.5;  ///< of each end; 0 where there is no endplate to be found
  double size_share = 0.2;    ///< of half the width and depth
  /// About the patient's x, y and z. A round body does not show how it is turned about z.
  Vec3 turn_rad = Vec3(0.3, 0.3, 0.05);
};

/// The cylinder near `start` with the most wall on its surface, found by a pattern search. All of its surface speaks at
/// once, so that a wall as thin as the noise is found.
BodyCylinder refine_body_cylinder(const WallProbe& probe, const BodyCylinder& start, const RefineLimits& limits = {});

}  // namespace spinaltap
