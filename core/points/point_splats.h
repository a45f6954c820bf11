#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/scalar_field.h"
#include "core/points/point_volume.h"
#include "core/tool/bit_profile.h"

namespace spinaltap {

/// A point of a volume as it is drawn: a disc that faces along its normal.
struct PointSplat {
  Eigen::Vector3f position_mm = Eigen::Vector3f::Zero();  ///< patient LPS
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();       ///< unit, away from the bone; zero while hidden
  float radius_mm = 0.0F;                                 ///< so that splats of a surface leave no gaps
  float alpha = 0.0F;                                     ///< 0: hidden within the bone, or gone; 1: shown
  std::int16_t hu = 0;
};

/// The points of a volume as one batch for a renderer, which keeps it in one buffer and skips what has no alpha (the
/// paper's section 8.2). Surface points, marked by the bone's distance, are shown from the start; inner ones as they
/// come to light, when a point beside them is removed. Nothing moves or is reordered: drilling only changes alphas, and
/// gives normals to what it brings to light.
class PointSplats {
 public:
  /// Splats of all points, disc by disc, in the order of the volume's indices. `bone`: the distance to its surface,
  /// whose gradient gives normals. A surface point is occupied and less than a spacing deep.
  PointSplats(const PointVolume& volume, const ScalarField& bone);

  /// Takes over which points of the volume are occupied. What has come to light since the last call faces the bit, or,
  /// where that is on its axis, the bit's base. Returns how many splats changed. `volume` is the one it was made from.
  std::size_t update(const PointVolume& volume, const DrillBit& bit, const Pose& pose);

  std::span<const PointSplat> splats() const { return splats_; }

 private:
  std::vector<PointSplat> splats_;
  std::vector<std::uint64_t> occupied_;  ///< as at the last call
  /// Of each point of a disc, those nearer than 1.5 spacings, itself too: from first_[n] to first_[n + 1].
  std::vector<std::uint32_t> neighbours_;
  std::vector<std::size_t> first_;
};

/// The splats that are shown, as PLY (binary, little endian): x, y, z, nx, ny, nz, radius in mm, patient LPS; red,
/// green, blue, alpha by CT number, cancellous bone red to cortex white; and hu. For MeshLab, Blender, CloudCompare,
/// ParaView.
std::string splats_ply(std::span<const PointSplat> splats);

}  // namespace spinaltap
