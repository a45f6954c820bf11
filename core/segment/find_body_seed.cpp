#include "core/segment/find_body_seed.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>

#include "core/base/error.h"
#include "core/segment/binned_ct.h"
#include "core/segment/body_cylinder.h"

namespace spinaltap {
namespace {

constexpr double kLatticeMm = 3.0;
constexpr double kRayMm = 36.0;
constexpr double kLeastWallMm = 6.0;  // half the height of the smallest bodies

std::vector<Vec3> directions_26() {
  std::vector<Vec3> directions;
  for (const double x : {-1.0, 0.0, 1.0}) {
    for (const double y : {-1.0, 0.0, 1.0}) {
      for (const double z : {-1.0, 0.0, 1.0}) {
        if (x != 0.0 || y != 0.0 || z != 0.0) directions.push_back(Vec3(x, y, z).normalized());
      }
    }
  }
  return directions;
}

/// How far the far side of the first bone lies along a ray, mm; 0 when there is none, or it lies too near.
double wall_mm(const FloatGrid& hu, const Vec3& from_mm, const Vec3& direction, double bone_hu) {
  bool met = false;
  for (double r = 0.0; r <= kRayMm; r += kLatticeMm) {
    const Vec3 p = hu.geometry.to_index(from_mm + r * direction);
    const Eigen::Array3i nearest = p.array().round().cast<int>();
    if (!hu.geometry.contains(nearest.x(), nearest.y(), nearest.z())) return 0.0;
    const bool is_bone = static_cast<double>(hu.at(nearest.x(), nearest.y(), nearest.z())) >= bone_hu;
    if (met && !is_bone && r >= kLeastWallMm) return r;
    met = met || is_bone;
  }
  return 0.0;
}

/// Share of directions with a wall, times the walls' mean distance.
double enclosure(const FloatGrid& hu, const Vec3& p_mm, double bone_hu) {
  static const std::vector<Vec3> directions = directions_26();
  constexpr int kLeastWalls = 20;
  int walls = 0;
  double sum_mm = 0.0;
  for (const Vec3& direction : directions) {
    const double here_mm = wall_mm(hu, p_mm, direction, bone_hu);
    walls += here_mm > 0.0 ? 1 : 0;
    sum_mm += here_mm;
  }
  return walls < kLeastWalls ? 0.0 : sum_mm * walls * walls;
}

struct CandidateSeed {
  Vec3 p_mm;
  double score;
};

std::vector<CandidateSeed> candidates_of(const FloatGrid& hu, double bone_hu) {
  const auto& size = hu.geometry.size;
  std::vector<std::vector<CandidateSeed>> by_slice(static_cast<std::size_t>(size[2]));
  tbb::parallel_for(0, size[2], [&](int k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        if (hu.at(i, j, k) < -50.0F) continue;  // fat and air
        const Vec3 p_mm = hu.geometry.to_patient(Vec3(i, j, k));
        const double score = enclosure(hu, p_mm, bone_hu);
        if (score > 0.0) by_slice[static_cast<std::size_t>(k)].push_back({p_mm, score});
      }
    }
  });
  std::vector<CandidateSeed> all;
  for (const auto& slice : by_slice) all.insert(all.end(), slice.begin(), slice.end());
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
  return all;
}

VoxelBox whole_of(const GridGeometry& geometry) {
  return {{0, 0, 0}, {geometry.size[0] - 1, geometry.size[1] - 1, geometry.size[2] - 1}};
}

/// The CT in steps of about 1 mm, blurred as its noise asks for: in larger ones a thin wall is no brighter than tissue.
FloatGrid fine_hu(const CtVolume& ct, const BoneLevels& levels) {
  constexpr double kStepMm = 1.0;
  return blurred_as_asked(bin_hu(ct, whole_of(ct.geometry), bins_for(ct.geometry, kStepMm)), levels, ct);
}

/// The greatest number in each block of about kLatticeMm: a wall within the block is seen however thin it is.
FloatGrid brightest_of_blocks(const FloatGrid& fine) {
  const std::array<int, 3> bins = bins_for(fine.geometry, kLatticeMm);
  FloatGrid grid;
  grid.geometry = binned_geometry(fine.geometry, whole_of(fine.geometry), bins);
  grid.values.assign(grid.geometry.voxel_count(), std::numeric_limits<float>::lowest());
  tbb::parallel_for(0, grid.geometry.size[2], [&](int k) {
    const int end = std::min((k + 1) * bins[2], fine.geometry.size[2]);
    for (int fk = k * bins[2]; fk < end; ++fk) {
      for (int fj = 0; fj < fine.geometry.size[1]; ++fj) {
        for (int fi = 0; fi < fine.geometry.size[0]; ++fi) {
          float& brightest = grid.values[grid.geometry.offset(fi / bins[0], fj / bins[1], k)];
          brightest = std::max(brightest, fine.at(fi, fj, fk));
        }
      }
    }
  });
  return grid;
}

bool is_within(const Vec3& p_mm, const GridGeometry& geometry) {
  const Eigen::Array3i nearest = geometry.to_index(p_mm).array().round().cast<int>();
  return geometry.contains(nearest.x(), nearest.y(), nearest.z());
}

}  // namespace

Vec3 find_body_seed(const CtVolume& ct, const BoneLevels& levels) {
  const FloatGrid hu = brightest_of_blocks(fine_hu(ct, levels));
  constexpr std::size_t kMostTried = 3;
  constexpr double kApartMm = 12.0;
  std::vector<Vec3> tried_mm;
  Vec3 best_mm = Vec3::Zero();
  double best = 0.0;
  for (const CandidateSeed& candidate : candidates_of(hu, levels.low_hu)) {
    if (tried_mm.size() == kMostTried) break;
    const bool is_near = std::any_of(tried_mm.begin(), tried_mm.end(),
                                     [&](const Vec3& p_mm) { return (p_mm - candidate.p_mm).norm() < kApartMm; });
    if (is_near) continue;
    tried_mm.push_back(candidate.p_mm);
    const BodyCylinder body = fit_body_cylinder(smooth_around(ct, candidate.p_mm), candidate.p_mm, {levels.low_hu});
    if (!body.is_body() || !is_within(body.centre_mm, ct.geometry) || body.worth() <= best) continue;
    best = body.worth();
    best_mm = body.centre_mm;
  }
  if (!(best > 0.0)) fail("found no vertebral body in the CT; give a point in it (--seed)");
  return best_mm;
}

}  // namespace spinaltap
