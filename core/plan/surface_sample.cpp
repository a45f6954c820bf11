#include "core/plan/surface_sample.h"

#include <cstdint>

namespace spinaltap {

SurfaceSample sample_surface(const BoneShape& bone) {
  constexpr double kCellMm = 1.0;
  GridGeometry cells;
  cells.origin_mm = bone.bounds_mm().min();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cells.size[axis] = static_cast<int>(bone.bounds_mm().sizes()[static_cast<Eigen::Index>(axis)] / kCellMm) + 1;
  }
  std::vector<std::uint8_t> taken(cells.voxel_count(), 0);
  SurfaceSample sample;
  for (std::size_t n = 0; n < bone.points_mm().size(); ++n) {
    const Vec3& p_mm = bone.points_mm()[n];
    const Eigen::Vector3i cell = ((p_mm - cells.origin_mm) / kCellMm).cast<int>();
    std::uint8_t& is_taken = taken[cells.offset(cell.x(), cell.y(), cell.z())];
    if (is_taken != 0) continue;
    is_taken = 1;
    sample.points_mm.push_back(p_mm);
    sample.normals.push_back(bone.normals()[n]);
    // A plane crosses |nx| + |ny| + |nz| cells per unit of its area.
    sample.areas_mm2.push_back(kCellMm * kCellMm / bone.normals()[n].lpNorm<1>());
  }
  return sample;
}

}  // namespace spinaltap
