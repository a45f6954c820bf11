#include "core/grading/detail/breach_field.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/anatomy/bone_shape.h"
#include "core/anatomy/wall_distance.h"

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
  constexpr double kSpacingMm = 3.0;  // at 2 grades and plans take a tenth longer: more places than they spare searches
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
  // By cubes of places. Where a wall is further than any tool reaches, what its middle says bounds them all: searches
  // for what is far away take longest.
  constexpr int kSide = 4;
  constexpr double kFarMm = 12.0, kHalfMm = 0.5 * (kSide - 1) * kSpacingMm;
  std::array<int, 3> cubes{};
  for (std::size_t axis = 0; axis < 3; ++axis) cubes[axis] = (geometry.size[axis] + kSide - 1) / kSide;
  tbb::parallel_for(0, cubes[0] * cubes[1] * cubes[2], [&](int cube) {
    const std::array<int, 3> low{kSide * (cube % cubes[0]), kSide * (cube / cubes[0] % cubes[1]),
                                 kSide * (cube / cubes[0] / cubes[1])};
    const Vec3 middle_mm = geometry.to_patient(Vec3(low[0], low[1], low[2])) + Vec3::Constant(kHalfMm);
    for (const bool is_canal : {false, true}) {
      FloatGrid& grid = is_canal ? canal_squared_mm2_ : outer_squared_mm2_;
      const auto to_wall_mm = [](const WallDistance::Wall& wall, const Vec3& p_mm) {
        return std::isfinite(wall.distance_mm) ? (p_mm - wall.nearest_mm).norm() : kNoWallMm;
      };
      WallDistance::Wall beside = walls_.further(middle_mm, is_canal, {});
      const double of_middle_mm = to_wall_mm(beside, middle_mm);
      const bool is_far = of_middle_mm - std::numbers::sqrt3 * kHalfMm > kFarMm;
      for (int k = low[2]; k < std::min(low[2] + kSide, geometry.size[2]); ++k) {
        for (int j = low[1]; j < std::min(low[1] + kSide, geometry.size[1]); ++j) {
          for (int i = low[0]; i < std::min(low[0] + kSide, geometry.size[0]); ++i) {
            const Vec3 p_mm = geometry.to_patient(Vec3(i, j, k));
            if (!is_far) beside = walls_.further(p_mm, is_canal, beside);
            const double mm = is_far ? of_middle_mm - (p_mm - middle_mm).norm() : to_wall_mm(beside, p_mm);
            grid.values[geometry.offset(i, j, k)] = static_cast<float>(mm * mm);
          }
        }
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
