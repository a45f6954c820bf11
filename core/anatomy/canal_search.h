#pragma once

#include <optional>

#include "core/anatomy/surface_sample.h"

namespace spinaltap {

/// A straight way through the vertebral canal.
struct CanalView {
  Vec3 point_mm = Vec3::Zero();  ///< on the way, at the height of the bone's middle
  Vec3 axis = Vec3::UnitZ();     ///< unit, upward
  double radius_mm = 0.0;        ///< of the widest cylinder around it that meets no bone
};

/// The direction, within 45 degrees of the patient's superior axis, from which a bone can best be seen through: its
/// silhouette has the hole with the largest inscribed circle. Nothing where no hole has a radius of 3 mm.
std::optional<CanalView> find_canal(const SurfaceSample& surface);

}  // namespace spinaltap
