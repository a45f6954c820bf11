#pragma once

#include <span>

#include "core/ct/density_law.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// Density (g/cm³) at patient positions (LPS, mm), by a law from the bone's tri-linear CT numbers. Both spans have one
/// length. Where the grid holds no CT number, beyond the bone and its margin, it is that of air: 0 by any usual law.
void bone_density(const BoneModel& bone, const DensityLaw& law, std::span<const Vec3> points_mm,
                  std::span<float> density_g_cm3);

}  // namespace spinaltap
