#include "core/anatomy/inside_bone.h"

#include <cmath>

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

}  // namespace spinaltap
