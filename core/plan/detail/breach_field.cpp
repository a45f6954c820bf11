#include "core/plan/detail/breach_field.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace spinaltap {
namespace {

constexpr double kNoWallMm = std::numeric_limits<double>::infinity();
/// What stands between the nearest sample and the surface's nearest place.
constexpr double kSampleSquared = BoneShape::kSampleMm * BoneShape::kSampleMm;

}  // namespace

BreachField::BreachField(const WallDistance& walls, const GradeOptions& options)
    : walls_(walls),
      points_mm_(walls.bone().points_mm()),
      step_mm_(options.step_mm),
      turns_(options.ring_points),
      side_turns_(kSideRingPoints),
      cells_(walls.bone().tree()) {
  std::array<std::uint32_t, 2> counts{};
  in_wall_.reserve(points_mm_.size());
  for (std::size_t n = 0; n < points_mm_.size(); ++n) in_wall_.push_back(counts[is_canal(n) ? 1 : 0]++);
  measure_walls();
}

WallDistance::Walls BreachField::walls(const Vec3& p_mm, const WallDistance::Walls& beside, std::size_t sample) const {
  WallDistance::Walls known = beside;
  (is_canal(sample) ? known.canal : known.outer).sample = in_wall_[sample];
  return walls_.walls(p_mm, known);
}

void BreachField::measure_walls() {
  constexpr double kSpacingMm = 2.0;
  GridGeometry geometry;
  geometry.origin_mm = bone().bounds_mm().min() - Vec3::Constant(kSpacingMm);
  geometry.spacing_mm = Vec3::Constant(kSpacingMm);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double side_mm = bone().bounds_mm().sizes()[static_cast<Eigen::Index>(axis)] + 2.0 * kSpacingMm;
    geometry.size[axis] = static_cast<int>(std::ceil(side_mm / kSpacingMm)) + 1;
  }
  for (FloatGrid* grid : {&outer_squared_mm2_, &canal_squared_mm2_}) {
    grid->geometry = geometry;
    grid->values.resize(geometry.voxel_count());
  }
  tbb::parallel_for(0, geometry.size[2], [&](int k) {
    WallDistance::Walls beside;
    const auto squared_to = [](const WallDistance::Wall& wall, const Vec3& p_mm) {
      return static_cast<float>(std::isfinite(wall.distance_mm) ? (p_mm - wall.nearest_mm).squaredNorm() : kNoWallMm);
    };
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const Vec3 p_mm = geometry.to_patient(Vec3(i, j, k));
        beside = walls_.walls(p_mm, beside);
        outer_squared_mm2_.values[geometry.offset(i, j, k)] = squared_to(beside.outer, p_mm);
        canal_squared_mm2_.values[geometry.offset(i, j, k)] = squared_to(beside.canal, p_mm);
      }
    }
  });
}

double BreachField::at_least_mm(const FloatGrid& to_wall_mm2, const Vec3& p_mm) {
  if (std::isinf(to_wall_mm2.values.front())) return kNoWallMm;
  // |p - s|² - |p|² is linear in p for each sample s. The least of it over the samples is therefore concave, and what
  // is interpolated between lattice places is not above it: only |p|² has to be corrected for its bend.
  const GridGeometry& geometry = to_wall_mm2.geometry;
  const Vec3 index = (p_mm - geometry.origin_mm).cwiseQuotient(geometry.spacing_mm);
  double bend_mm2 = 0.0, outside_squared = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double last = geometry.size[static_cast<std::size_t>(axis)] - 1;
    const double inside = std::clamp(index[axis], 0.0, last);
    const double share = inside - std::floor(inside);
    const double spacing_squared = geometry.spacing_mm[axis] * geometry.spacing_mm[axis];
    bend_mm2 += share * (1.0 - share) * spacing_squared;
    outside_squared += (index[axis] - inside) * (index[axis] - inside) * spacing_squared;
  }
  constexpr double kRoundingShare = 1e-5;  // of float
  const double squared_mm2 = sample_clamped(to_wall_mm2, index) * (1.0 - kRoundingShare) - bend_mm2 - kSampleSquared;
  return squared_mm2 > 0.0 ? std::max(0.0, std::sqrt(squared_mm2) - std::sqrt(outside_squared)) : 0.0;
}

}  // namespace spinaltap
