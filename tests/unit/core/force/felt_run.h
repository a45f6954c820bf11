#pragma once

#include <functional>
#include <vector>

#include "core/force/drill_forces.h"
#include "tests/unit/core/engine/askew_block.h"

namespace spinaltap::test {

constexpr double kCycleS = 0.001;
/// Of even blocks.
constexpr double kFeltHu = 400.0;

/// HU of a density by the material's line.
inline double hu_of(const Material& material, double density_g_cm3) {
  return (density_g_cm3 - material.density.at_0_hu) / material.density.per_hu;
}

/// Kills the points that are not bone, and gives the others their density.
inline void fill_density(PointVolume& volume, const Material& material,
                         const std::function<double(const Vec3&)>& density_g_cm3) {
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) {
      const double density = density_g_cm3(volume.point_in_path_mm(disc, i));
      volume.set_occupied(disc, i, density > 0.0);
      volume.set_hu(disc, i, hu_of(material, density));
    }
  }
}

/// A bit in a volume, with its engine and forces, moved cycle by cycle.
class FeltBit {
 public:
  FeltBit(PointVolume& volume, const DrillBit& bit, const Material& material = {}, const Spindle& spindle = {})
      : volume_(volume),
        engine_(make_ring_engine(volume, bit, material)),
        forces_({&volume, 1}, bit, material),
        spindle_(spindle) {}

  const DrillForce& move_to(const Vec3& tip_path_mm, const Vec3& axis_path = Vec3::UnitZ(), double dt_s = kCycleS) {
    const Pose pose = pose_at(volume_, tip_path_mm, axis_path);
    last_ = forces_.update(spindle_.rpm > 0.0 ? engine_->step(pose) : StepResult{}, pose, dt_s, spindle_);
    return last_;
  }
  /// Straight on in z, `step_mm` a cycle.
  void drill(Vec3 from_mm, double to_z_mm, double step_mm,
             const std::function<void(double z_mm, const DrillForce&)>& see = {}) {
    const auto cycles = static_cast<long>(std::floor((to_z_mm - from_mm.z()) / step_mm + 1e-6));
    for (long n = 0; n <= cycles; ++n) {
      const double z_mm = from_mm.z() + static_cast<double>(n) * step_mm;
      const DrillForce& force = move_to(Vec3(from_mm.x(), from_mm.y(), z_mm));
      if (see) see(z_mm, force);
    }
  }
  /// A vector of patient LPS along the path's axes.
  Vec3 along_path(const Vec3& patient) const {
    return volume_.frame().to_path(Pose{volume_.frame().to_patient(Vec3::Zero()), patient}).axis;
  }
  Spindle& spindle() { return spindle_; }
  DrillForces& forces() { return forces_; }
  DrillEngine& engine() { return *engine_; }

 private:
  PointVolume& volume_;
  std::unique_ptr<DrillEngine> engine_;
  DrillForces forces_;
  Spindle spindle_;
  DrillForce last_;
};

inline double feed_mm(double step_mm, const Spindle& spindle) { return step_mm / kCycleS * 60.0 / spindle.rpm; }

}  // namespace spinaltap::test
