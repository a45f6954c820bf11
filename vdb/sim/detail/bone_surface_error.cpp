#include "vdb/sim/detail/bone_surface_error.h"

#include <algorithm>
#include <vector>

#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

std::optional<std::vector<double>> numbers_in(const BoneModel& bone, const char* key) {
  const auto found = bone.metadata().find(key);
  return found == bone.metadata().end() ? std::nullopt : parse_numbers(found->second);
}

/// Nothing where a bone does not say what its CT's voxels are. Bones of earlier versions know no thickness of slices.
std::optional<CtSampling> sampling_in(const BoneModel& bone) {
  const auto voxel_mm = numbers_in(bone, kCtSpacing);
  if (!voxel_mm || voxel_mm->size() != 3) return std::nullopt;
  CtSampling sampling;
  sampling.voxel_mm = Vec3((*voxel_mm)[0], (*voxel_mm)[1], (*voxel_mm)[2]);
  if (const auto axes = numbers_in(bone, kCtDirections); axes && axes->size() == 9) {
    sampling.directions = Eigen::Map<const Mat3>(axes->data());  // a column after the other
  }
  if (const auto thick_mm = numbers_in(bone, kCtSliceThickness); thick_mm && thick_mm->size() == 1) {
    sampling.slice_thickness_mm = std::max(0.0, thick_mm->front());
  }
  return sampling;
}

}  // namespace

std::optional<CtSurfaceError> bone_surface_error(const BoneModel& bone, const BoneShape& shape) {
  constexpr std::size_t kPlaces = 20000;
  const auto noise_hu = numbers_in(bone, kCtNoise);
  const std::optional<CtSampling> sampling = sampling_in(bone);
  if (!noise_hu || noise_hu->size() != 1 || !sampling) return std::nullopt;
  const std::size_t step = std::max<std::size_t>(1, shape.points_mm().size() / kPlaces);
  std::vector<Vec3> places_mm, normals;
  for (std::size_t n = 0; n < shape.points_mm().size(); n += step) {
    places_mm.push_back(shape.points_mm()[n]);
    normals.push_back(shape.normals()[n]);
  }
  std::vector<float> hu(places_mm.size());
  std::vector<Vec3> gradients(places_mm.size());
  bone.hu(places_mm, hu, gradients);
  std::vector<double> slopes;
  slopes.reserve(places_mm.size());
  for (std::size_t n = 0; n < places_mm.size(); ++n) slopes.push_back(-gradients[n].dot(normals[n]));
  std::nth_element(slopes.begin(), slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2), slopes.end());
  if (!(slopes[slopes.size() / 2] > 0.0) || !(noise_hu->front() >= 0.0)) return std::nullopt;
  return ct_surface_error(noise_hu->front(), *sampling, slopes, normals);
}

}  // namespace spinaltap
