#include "apps/common/bone_path.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {

DrillPath suggest_path(const BoneModel& bone, const DrillBit& bit, const Progress& progress) {
  constexpr double kVoxelMm = 1.0;
  const Box3 bounds_mm = bone.bounds_mm();
  BoneMask mask;
  mask.geometry.origin_mm = bounds_mm.min() - Vec3::Constant(2.0 * kVoxelMm);
  mask.geometry.spacing_mm = Vec3::Constant(kVoxelMm);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    mask.geometry.size[axis] = static_cast<int>(bounds_mm.sizes()[static_cast<Eigen::Index>(axis)] / kVoxelMm) + 5;
  }
  check_geometry(mask.geometry, "search for a path", std::size_t{1} << 27);
  const auto& size = mask.geometry.size;
  std::vector<Vec3> row_mm(static_cast<std::size_t>(size[0]));
  std::vector<float> distance_mm(row_mm.size());
  mask.inside.reserve(mask.geometry.voxel_count());
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) row_mm[static_cast<std::size_t>(i)] = mask.geometry.to_patient(Vec3(i, j, k));
      bone.sample(row_mm, distance_mm, {});
      for (const float value : distance_mm) mask.inside.push_back(value < 0.0F ? 1 : 0);
    }
  }
  return widest_corridor(mask, bit, {}, progress);
}

void check_path_meets_bone(const DrillPath& path, const BoneModel& bone) {
  constexpr double kStepMm = 0.1;
  const int steps = static_cast<int>(std::ceil(path.length_mm() / kStepMm));
  std::vector<Vec3> points_mm;
  for (int i = 0; i <= steps; ++i) {
    points_mm.push_back(path.entry_mm + (path.target_mm - path.entry_mm) * i / steps);
  }
  std::vector<float> distance_mm(points_mm.size());
  bone.sample(points_mm, distance_mm, {});
  if (std::any_of(distance_mm.begin(), distance_mm.end(), [](float value) { return value < 0.0F; })) return;
  const Box3 bounds_mm = bone.bounds_mm();
  const Eigen::IOFormat format(4, Eigen::DontAlignCols, ", ", ", ");
  fail("path \"", path.name, "\" misses the bone: it runs from (", path.entry_mm.transpose().format(format), ") to (",
       path.target_mm.transpose().format(format), "), the bone lies within (",
       bounds_mm.min().transpose().format(format), ") and (", bounds_mm.max().transpose().format(format), ") mm");
}

}  // namespace spinaltap
