#pragma once

#include <array>

#include "core/points/bone_points.h"

namespace spinaltap {

/// The bone just ahead of a bit's chisel edge: one spacing ahead of the tip, by a line between the next two discs, so
/// that it is as smooth as the bone. What is missing counts as bone of no density.
class TipBone {
 public:
  /// `edge_radius_mm`: of the disc that the chisel edge turns over.
  TipBone(const BonePoints& bone, double edge_radius_mm) : bone_(&bone), edge_radius_mm_(edge_radius_mm) {}

  struct Mean {
    double density_g_cm3 = 0.0;
    double chisel_mpa = 0.0;
  };
  /// `pose` in the bone's coordinates.
  Mean ahead_of(const Pose& pose) const noexcept;

 private:
  const BonePoints* bone_;
  double edge_radius_mm_;
};

}  // namespace spinaltap
