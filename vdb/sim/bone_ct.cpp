#include "vdb/sim/bone_ct.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace spinaltap {

CtVolume ct_of_bone(const BoneModel& bone, double voxel_mm) {
  constexpr double kMarginMm = 2.0;
  const Box3 bounds_mm = bone.bounds_mm();
  GridGeometry geometry;
  geometry.origin_mm = bounds_mm.min() - Vec3::Constant(kMarginMm);
  geometry.spacing_mm = Vec3::Constant(voxel_mm);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double side_mm = bounds_mm.sizes()[static_cast<Eigen::Index>(axis)] + 2.0 * kMarginMm;
    geometry.size[axis] = static_cast<int>(std::ceil(side_mm / voxel_mm)) + 1;
  }
  check_geometry(geometry, "the bone's CT", std::size_t{1} << 28);
  std::vector<std::int16_t> voxels(geometry.voxel_count());
  tbb::parallel_for(0, geometry.size[2], [&](int k) {
    std::vector<Vec3> row_mm(static_cast<std::size_t>(geometry.size[0]));
    std::vector<float> hu(row_mm.size());
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        row_mm[static_cast<std::size_t>(i)] = geometry.to_patient(Vec3(i, j, k));
      }
      bone.hu(row_mm, hu, {});
      std::transform(
          hu.begin(), hu.end(), voxels.begin() + static_cast<std::ptrdiff_t>(geometry.offset(0, j, k)),
          [](float value) { return static_cast<std::int16_t>(std::lround(std::clamp(value, -32768.0F, 32767.0F))); });
    }
  });
  return make_ct_volume(geometry, std::move(voxels));
}

}  // namespace spinaltap
