#include "core/plan/detail/inside_bone.h"

#include <cmath>

namespace spinaltap {

std::vector<std::uint8_t> inside_bone(const BoneShape& bone, std::span<const Vec3> points_mm) {
  std::vector<std::uint8_t> inside(points_mm.size(), 0);
  std::vector<std::size_t> doubtful;
  std::vector<Vec3> doubtful_mm;
  for (std::size_t n = 0; n < points_mm.size(); ++n) {
    const double lattice_mm = bone.lattice_mm(points_mm[n]);
    if (std::abs(lattice_mm) > kSureLatticeMm) {
      inside[n] = lattice_mm < 0.0 ? 1 : 0;
    } else {
      doubtful.push_back(n);
      doubtful_mm.push_back(points_mm[n]);
    }
  }
  std::vector<double> values_mm(doubtful.size());
  if (!doubtful.empty()) bone.surface().evaluate(doubtful_mm, values_mm, {});
  for (std::size_t n = 0; n < doubtful.size(); ++n) inside[doubtful[n]] = values_mm[n] < 0.0 ? 1 : 0;
  return inside;
}

}  // namespace spinaltap
