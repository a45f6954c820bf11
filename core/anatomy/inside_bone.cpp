#include "core/anatomy/inside_bone.h"

#include <cmath>
#include <limits>

namespace spinaltap {

std::vector<std::uint8_t> inside_bone(const BoneShape& bone, std::span<const Vec3> points_mm) {
  std::vector<std::uint8_t> inside(points_mm.size(), 0);
  std::vector<std::size_t> suspect;
  std::vector<Vec3> suspect_mm;
  for (std::size_t n = 0; n < points_mm.size(); ++n) {
    const double lattice_mm = bone.lattice_mm(points_mm[n]);
    if (std::abs(lattice_mm) > kSureLatticeMm) {
      inside[n] = lattice_mm < 0.0 ? 1 : 0;
    } else {
      suspect.push_back(n);
      suspect_mm.push_back(points_mm[n]);
    }
  }
  std::vector<double> values_mm(suspect.size());
  if (!suspect.empty()) bone.surface().evaluate(suspect_mm, values_mm, {});
  for (std::size_t n = 0; n < suspect.size(); ++n) inside[suspect[n]] = values_mm[n] < 0.0 ? 1 : 0;
  return inside;
}

std::vector<float> hu_inside_bone(const BoneShape& bone, const HuSampler& hu, std::span<const Vec3> points_mm) {
  const std::vector<std::uint8_t> inside = inside_bone(bone, points_mm);
  std::vector<Vec3> in_bone_mm;
  for (std::size_t n = 0; n < points_mm.size(); ++n) {
    if (inside[n] != 0) in_bone_mm.push_back(points_mm[n]);
  }
  std::vector<float> found_hu(in_bone_mm.size());
  if (!in_bone_mm.empty()) hu(in_bone_mm, found_hu);
  std::vector<float> values_hu(points_mm.size(), std::numeric_limits<float>::quiet_NaN());
  std::size_t next = 0;
  for (std::size_t n = 0; n < points_mm.size(); ++n) {
    if (inside[n] != 0) values_hu[n] = found_hu[next++];
  }
  return values_hu;
}

}  // namespace spinaltap
