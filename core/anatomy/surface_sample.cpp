#include "core/anatomy/surface_sample.h"

#include <cmath>

#include "core/base/error.h"

namespace spinaltap {

std::vector<std::size_t> first_of_each_cell(std::span<const Vec3> points_mm, const Vec3& origin_mm, double cell_mm) {
  constexpr double kMaxCells = 4294967296.0;
  const auto cell_of = [&](const Vec3& p_mm) -> Vec3 { return ((p_mm - origin_mm) / cell_mm).array().floor(); };
  Box3 box;
  for (const Vec3& p_mm : points_mm) {
    if (!p_mm.allFinite()) fail("thinning points: expected numbers, found a position that is none");
    box.extend(cell_of(p_mm));
  }
  if (points_mm.empty()) return {};
  const Vec3 size = box.sizes() + Vec3::Ones();
  if (!(size.prod() <= kMaxCells)) {
    fail("thinning points: expected them in up to ", kMaxCells, " cells, found a box of ", size.x(), " x ", size.y(),
         " x ", size.z());
  }
  std::vector<bool> is_taken(static_cast<std::size_t>(size.prod()), false);
  std::vector<std::size_t> first;
  for (std::size_t n = 0; n < points_mm.size(); ++n) {
    const Vec3 cell = cell_of(points_mm[n]) - box.min();
    // Whole numbers, exact in doubles up to 2^53.
    const auto place = static_cast<std::size_t>((cell.z() * size.y() + cell.y()) * size.x() + cell.x());
    if (is_taken[place]) continue;
    is_taken[place] = true;
    first.push_back(n);
  }
  return first;
}

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
