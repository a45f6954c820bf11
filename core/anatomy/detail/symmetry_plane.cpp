#include "core/anatomy/detail/symmetry_plane.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/segment/distance_transform.h"

namespace spinaltap {
namespace {

Vec3 mirrored(const Vec3& p_mm, const SymmetryPlane& plane) {
  return p_mm - 2.0 * (p_mm - plane.point_mm).dot(plane.normal) * plane.normal;
}

/// The plane turned by `turns` (rad, about the two axes) and moved by `shift_mm` along its normal.
SymmetryPlane moved(const SymmetryPlane& plane, const Vec3& posterior, const Vec3& superior,
                    const Vec3& turns_and_shift) {
  SymmetryPlane result = plane;
  result.normal =
      (plane.normal + std::tan(turns_and_shift[0]) * posterior + std::tan(turns_and_shift[1]) * superior).normalized();
  result.point_mm += turns_and_shift[2] * plane.normal;
  return result;
}

/// Distances to the surface, mm, at the nearest voxel of 1 mm.
class DistanceMap {
 public:
  DistanceMap(const SurfaceSample& surface, const Box3& bounds_mm) {
    constexpr double kMarginMm = 4.0;
    map_.origin_mm = bounds_mm.min() - Vec3::Constant(kMarginMm);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      map_.size[axis] = static_cast<int>(bounds_mm.sizes()[static_cast<Eigen::Index>(axis)] + 2.0 * kMarginMm) + 2;
    }
    std::vector<std::uint8_t> marked(map_.voxel_count(), 0);
    for (const Vec3& p_mm : surface.points_mm) marked[*offset_of(p_mm)] = 1;
    squared_mm2_ = squared_distance_to(marked, map_);
  }

  /// At most `max_mm`.
  double at(const Vec3& p_mm, double max_mm) const {
    const std::optional<std::size_t> offset = offset_of(p_mm);
    return offset ? std::min(max_mm, std::sqrt(static_cast<double>(squared_mm2_[*offset]))) : max_mm;
  }

 private:
  std::optional<std::size_t> offset_of(const Vec3& p_mm) const {
    const Eigen::Array3d voxel = (p_mm - map_.origin_mm).array().round();
    if (!(voxel >= 0.0).all()) return std::nullopt;
    const Eigen::Array3i index = voxel.cast<int>();
    if (!map_.contains(index[0], index[1], index[2])) return std::nullopt;
    return map_.offset(index[0], index[1], index[2]);
  }

  GridGeometry map_;
  std::vector<float> squared_mm2_;
};

SymmetryPlane best_of_grid(const DistanceMap& map, const std::vector<Vec3>& points_mm, const SymmetryPlane& start,
                           const Vec3& posterior, const Vec3& superior) {
  constexpr double kTruncateMm = 4.0;
  constexpr int kTurns = 5, kShifts = 3;
  constexpr double kTurn = 4.0 * kDegree, kShiftMm = 2.0;
  std::vector<Vec3> moves;
  for (int a = -kTurns; a <= kTurns; ++a) {
    for (int b = -kTurns; b <= kTurns; ++b) {
      for (int c = -kShifts; c <= kShifts; ++c) moves.emplace_back(kTurn * a, kTurn * b, kShiftMm * c);
    }
  }
  std::vector<double> costs(moves.size());
  tbb::parallel_for(std::size_t{0}, moves.size(), [&](std::size_t n) {
    const SymmetryPlane plane = moved(start, posterior, superior, moves[n]);
    for (const Vec3& p_mm : points_mm) costs[n] += map.at(mirrored(p_mm, plane), kTruncateMm);
  });
  const auto best = std::min_element(costs.begin(), costs.end()) - costs.begin();
  return moved(start, posterior, superior, moves[static_cast<std::size_t>(best)]);
}

/// Distances of the mirrored points to the tangent planes at their nearest points, and those.
struct Matches {
  std::vector<double> residuals_mm;
  std::vector<std::size_t> nearest;
};

Matches match(const BoneShape& bone, const std::vector<Vec3>& points_mm, const SymmetryPlane& plane) {
  Matches matches{std::vector<double>(points_mm.size()), std::vector<std::size_t>(points_mm.size())};
  tbb::parallel_for(std::size_t{0}, points_mm.size(), [&](std::size_t n) {
    const Vec3 image_mm = mirrored(points_mm[n], plane);
    matches.nearest[n] = bone.nearest(image_mm).index;
    matches.residuals_mm[n] = bone.normals()[matches.nearest[n]].dot(image_mm - bone.points_mm()[matches.nearest[n]]);
  });
  return matches;
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

SymmetryPlane find_symmetry_plane(const BoneShape& bone, const SurfaceSample& surface, const SymmetryPlane& start,
                                  const Vec3& posterior, const Vec3& superior) {
  constexpr std::size_t kMaxPoints = 2000;
  constexpr int kRounds = 9;
  constexpr double kWideMm = 3.0, kNarrowMm = 1.0, kDifference = 1e-4;
  std::vector<Vec3> points_mm;
  const std::size_t step = std::max<std::size_t>(1, surface.points_mm.size() / kMaxPoints);
  for (std::size_t n = 0; n < surface.points_mm.size(); n += step) points_mm.push_back(surface.points_mm[n]);
  SymmetryPlane plane = best_of_grid(DistanceMap(surface, bone.bounds_mm()), points_mm, start, posterior, superior);
  for (int round = 0; round < kRounds; ++round) {
    const Matches matches = match(bone, points_mm, plane);
    const double reach_mm = std::max(kNarrowMm, kWideMm * (1.0 - round / (0.5 * kRounds)));
    Mat3 normal_matrix = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    std::array<SymmetryPlane, 3> nearby;
    for (int axis = 0; axis < 3; ++axis) {
      nearby[static_cast<std::size_t>(axis)] = moved(plane, posterior, superior, kDifference * Vec3::Unit(axis));
    }
    for (std::size_t n = 0; n < points_mm.size(); ++n) {
      const double ratio = matches.residuals_mm[n] / reach_mm;
      if (!(std::abs(ratio) < 1.0)) continue;
      const double weight = (1.0 - ratio * ratio) * (1.0 - ratio * ratio);
      const Vec3 image_mm = mirrored(points_mm[n], plane);
      Vec3 slope;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        slope[static_cast<Eigen::Index>(axis)] =
            bone.normals()[matches.nearest[n]].dot(mirrored(points_mm[n], nearby[axis]) - image_mm) / kDifference;
      }
      normal_matrix += weight * slope * slope.transpose();
      right -= weight * matches.residuals_mm[n] * slope;
    }
    const Vec3 change = normal_matrix.ldlt().solve(right);
    if (!change.allFinite()) break;
    plane = moved(plane, posterior, superior, change.cwiseMax(Vec3(-0.1, -0.1, -2.0)).cwiseMin(Vec3(0.1, 0.1, 2.0)));
  }
  std::vector<double> distances_mm = match(bone, points_mm, plane).residuals_mm;
  for (double& distance_mm : distances_mm) distance_mm = std::abs(distance_mm);
  plane.residual_mm = median_of(std::move(distances_mm));
  return plane;
}

}  // namespace spinaltap
