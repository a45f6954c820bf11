#include "core/plan/surface_sample.h"

#include "core/plan/first_of_each_cell.h"

namespace spinaltap {

SurfaceSample sample_surface(const BoneShape& bone) {
  constexpr double kCellMm = 1.0;
  SurfaceSample sample;
  for (const std::size_t n : first_of_each_cell(bone.points_mm(), bone.bounds_mm().min(), kCellMm)) {
    sample.points_mm.push_back(bone.points_mm()[n]);
    sample.normals.push_back(bone.normals()[n]);
    // A plane crosses |nx| + |ny| + |nz| cells per unit of its area.
    sample.areas_mm2.push_back(kCellMm * kCellMm / bone.normals()[n].lpNorm<1>());
  }
  return sample;
}

}  // namespace spinaltap
