#include "vdb/sim/detail/bone_surface_error.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

std::optional<std::vector<double>> numbers_in(const BoneModel& bone, const char* key) {
  const auto found = bone.metadata().find(key);
  if (found == bone.metadata().end()) return std::nullopt;
  std::vector<double> numbers;
  std::istringstream fields(found->second);
  for (std::string field; fields >> field;) {
    const std::optional<double> number = parse_number(field);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

}  // namespace

std::optional<CtSurfaceError> bone_surface_error(const BoneModel& bone, const BoneShape& shape) {
  constexpr std::size_t kPlaces = 20000;
  const auto noise_hu = numbers_in(bone, kCtNoise);
  const auto voxel_mm = numbers_in(bone, kCtSpacing);
  if (!noise_hu || noise_hu->size() != 1 || !voxel_mm || voxel_mm->size() != 3) return std::nullopt;
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
  return ct_surface_error(noise_hu->front(), Vec3((*voxel_mm)[0], (*voxel_mm)[1], (*voxel_mm)[2]), slopes);
}

}  // namespace spinaltap
