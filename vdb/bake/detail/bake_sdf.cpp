#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/Morphology.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/base/error.h"
#include "vdb/bake/detail/bake_sdf.h"
#include "vdb/bake/detail/closest_points.h"
#include "vdb/bake/detail/evaluate_batches.h"
#include "vdb/bake/detail/one_piece.h"
#include "vdb/detail/bone_grids.h"

namespace spinaltap::detail {
namespace {

using openvdb::Coord;

/// Evaluates the field in every voxel that `wanted` has and `grid` has not, and sets its first-order distance there and
/// the way to the zero set. Voxels where the distance is below `near_mm` go into `near`.
std::size_t evaluate_voxels(const ScalarField& field, const openvdb::MaskTree& wanted, double voxel_mm, double near_mm,
                            openvdb::FloatGrid& grid, openvdb::Vec3SGrid& ways, openvdb::MaskTree& near,
                            const Progress& progress) {
  std::vector<Coord> voxels;
  for (auto voxel = wanted.cbeginValueOn(); voxel; ++voxel) {
    openvdb::CoordBBox box;
    voxel.getBoundingBox(box);
    for (auto at = box.begin(); at; ++at) {
      if (!grid.tree().isValueOn(*at)) voxels.push_back(*at);
    }
  }
  std::vector<float> distance_mm(voxels.size());
  std::vector<openvdb::Vec3s> way_mm(voxels.size());
  evaluate_batches(
      field, voxels.size(), "baking the distance", progress,
      [&](std::size_t i) -> Vec3 { return voxel_mm * Vec3(voxels[i].x(), voxels[i].y(), voxels[i].z()); },
      [&](std::size_t i, double value_mm, const Vec3& gradient) {
        // Where the gradient vanishes the value says nothing of the distance; a tenth keeps the result finite.
        const double slope = std::max(gradient.norm(), 0.1);
        distance_mm[i] = static_cast<float>(value_mm / slope);
        way_mm[i] = openvdb::Vec3s(to_vdb(-value_mm / (slope * slope) * gradient));
      });
  auto accessor = grid.getAccessor();
  auto ways_accessor = ways.getAccessor();
  openvdb::tree::ValueAccessor<openvdb::MaskTree> near_accessor(near);
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    if (!std::isfinite(distance_mm[i])) fail("baking: the field is not a number at a voxel");
    accessor.setValue(voxels[i], distance_mm[i]);
    ways_accessor.setValue(voxels[i], way_mm[i]);
    if (std::abs(static_cast<double>(distance_mm[i])) < near_mm) near_accessor.setValueOn(voxels[i]);
  }
  return voxels.size();
}

/// Whether the grid holds both inside and outside voxels: a surface. Specks of the band deep inside do not.
bool has_surface(const openvdb::FloatGrid& grid) {
  bool any_inside = false;
  bool any_outside = false;
  for (auto voxel = grid.cbeginValueOn(); voxel && !(any_inside && any_outside); ++voxel) {
    (*voxel < 0.0F ? any_inside : any_outside) = true;
  }
  return any_inside && any_outside;
}

/// Seeds that lie off the zero set, as those of a much smoothed function do, moved onto it along the gradient.
std::vector<Vec3> drawn_to_zero_set(const ScalarField& field, std::span<const Vec3> seeds_mm, double near_mm) {
  constexpr int kMaxRounds = 8;
  constexpr double kLongestStepMm = 2.0;
  std::vector<Vec3> places_mm(seeds_mm.begin(), seeds_mm.end());
  std::vector<std::size_t> away(places_mm.size());
  std::iota(away.begin(), away.end(), std::size_t{0});
  for (int round = 0; round < kMaxRounds && !away.empty(); ++round) {
    std::vector<Vec3> asked_mm;
    asked_mm.reserve(away.size());
    for (const std::size_t i : away) asked_mm.push_back(places_mm[i]);
    std::vector<double> values_mm(asked_mm.size());
    std::vector<Vec3> gradients(asked_mm.size());
    field.evaluate(asked_mm, values_mm, gradients);
    std::vector<std::size_t> still_away;
    for (std::size_t n = 0; n < away.size(); ++n) {
      const double slope = gradients[n].norm();
      const double way_mm = std::clamp(values_mm[n] / std::max(slope, 1e-3), -kLongestStepMm, kLongestStepMm);
      if (!(std::abs(way_mm) > near_mm)) continue;
      places_mm[away[n]] -= way_mm * gradients[n] / std::max(slope, 1e-3);
      still_away.push_back(away[n]);
    }
    away = std::move(still_away);
  }
  return places_mm;
}

}  // namespace

openvdb::FloatGrid::Ptr bake_sdf(const ScalarField& field, std::span<const Vec3> seeds_mm, double voxel_mm,
                                 BakeReport& report, const Progress& progress) {
  constexpr double kFarthestSeedMm = 1e5;
  constexpr double kLongestWayMm = 300.0;  // from the seeds, along the surface: longer than any vertebra is round
  // A cell that the surface cuts has all its corners nearer than sqrt(3) voxels, and one, whose neighbours the others
  // are, nearer than half of that; some more is for the error of first-order distances.
  constexpr double kCornerVoxels = 2.2;
  constexpr double kNearVoxels = 1.05;
  // A number that half floats have: a file of them gives it back.
  const float band = rounded_to_half(static_cast<float>(kHalfWidthVoxels * voxel_mm));
  openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(band);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel_mm));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);

  auto wanted = std::make_shared<openvdb::MaskTree>();
  {
    openvdb::tree::ValueAccessor<openvdb::MaskTree> accessor(*wanted);
    for (const Vec3& p : seeds_mm) {
      if (!(p.array().abs() <= kFarthestSeedMm).all()) {
        fail("baking: expected seeds within ", kFarthestSeedMm, " mm of the origin, found ", p.transpose());
      }
    }
    for (const Vec3& p : drawn_to_zero_set(field, seeds_mm, 0.5 * voxel_mm)) {
      if (!(p.array().abs() <= kFarthestSeedMm).all()) continue;
      accessor.setValueOn(Coord::round(to_vdb(p / voxel_mm)));
    }
  }
  openvdb::tools::dilateActiveValues(*wanted, 1, openvdb::tools::NN_FACE_EDGE_VERTEX, openvdb::tools::IGNORE_TILES);

  // Each round evaluates the neighbours of the voxels near the surface, one voxel further, until all of those are
  // known.
  openvdb::Vec3SGrid ways;
  const int max_rounds = static_cast<int>(std::ceil(kLongestWayMm / voxel_mm));
  for (int round = 0;; ++round) {
    if (round == max_rounds) fail("baking: the zero set does not close within ", kLongestWayMm, " mm of the seeds");
    auto near = std::make_shared<openvdb::MaskTree>();
    const std::size_t evaluated =
        evaluate_voxels(field, *wanted, voxel_mm, kNearVoxels * voxel_mm, *grid, ways, *near, progress);
    report.evaluations += evaluated;
    if (evaluated == 0) break;
    openvdb::tools::dilateActiveValues(*near, 1, openvdb::tools::NN_FACE_EDGE_VERTEX, openvdb::tools::IGNORE_TILES);
    wanted = near;
  }

  for (auto voxel = grid->beginValueOn(); voxel; ++voxel) {
    const float value = *voxel;
    // Only the surface's own neighbourhood is kept; the rest is swept from it.
    if (std::abs(value) >= static_cast<float>(kCornerVoxels * voxel_mm)) {
      voxel.setValue(value < 0.0F ? -band : band);
      voxel.setValueOff();
    }
  }
  if (!has_surface(*grid)) fail("baking: the field has no zero set near the ", seeds_mm.size(), " seeds");
  openvdb::tools::signedFloodFill(grid->tree());
  report.dropped_pieces = keep_one_piece(grid);

  grid = with_true_distances(*grid, ways, field, band, report.evaluations, progress);
  grid->setName("sdf");
  return grid;
}

}  // namespace spinaltap::detail
