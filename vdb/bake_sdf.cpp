#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/FastSweeping.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/Morphology.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "vdb/detail/bake_sdf.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/one_piece.h"

namespace spinaltap::detail {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using Mask = openvdb::MaskTree;

/// Evaluates the field in every voxel that `wanted` has and `grid` has not, and sets its first-order distance there.
/// Voxels where it is below `near_mm` go into `near`.
std::size_t evaluate_voxels(const ScalarField& field, const Mask& wanted, double voxel_mm, double near_mm,
                            FloatGrid& grid, Mask& near, const Progress& progress) {
  std::vector<Coord> voxels;
  for (auto voxel = wanted.cbeginValueOn(); voxel; ++voxel) {
    openvdb::CoordBBox box;
    voxel.getBoundingBox(box);
    for (auto at = box.begin(); at; ++at) {
      if (!grid.tree().isValueOn(*at)) voxels.push_back(*at);
    }
  }
  constexpr std::size_t kBatch = 1 << 14;  // fields sort their points: the more at once, the better
  const std::size_t batches = (voxels.size() + kBatch - 1) / kBatch;
  std::vector<float> distance_mm(voxels.size());
  ProgressCounter counter(progress, "baking the distance", batches);
  tbb::parallel_for(std::size_t{0}, batches, [&](std::size_t batch) {
    const std::size_t begin = batch * kBatch;
    const std::size_t size = std::min(kBatch, voxels.size() - begin);
    std::vector<Vec3> points_mm(size);
    std::vector<double> values_mm(size);
    std::vector<Vec3> gradients(size);
    for (std::size_t i = 0; i < size; ++i) {
      const Coord& voxel = voxels[begin + i];
      points_mm[i] = voxel_mm * Vec3(voxel.x(), voxel.y(), voxel.z());
    }
    field.evaluate(points_mm, values_mm, gradients);
    for (std::size_t i = 0; i < size; ++i) {
      // Where the gradient vanishes the value says nothing of the distance; a tenth keeps the result finite.
      distance_mm[begin + i] = static_cast<float>(values_mm[i] / std::max(gradients[i].norm(), 0.1));
    }
    counter.add();
  });
  auto accessor = grid.getAccessor();
  openvdb::tree::ValueAccessor<Mask> near_accessor(near);
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    if (!std::isfinite(distance_mm[i])) fail("baking: the field is not a number at a voxel");
    accessor.setValue(voxels[i], distance_mm[i]);
    if (std::abs(static_cast<double>(distance_mm[i])) < near_mm) near_accessor.setValueOn(voxels[i]);
  }
  return voxels.size();
}

/// Whether the grid holds both inside and outside voxels: a surface. Specks of the band deep inside do not.
bool has_surface(const FloatGrid& grid) {
  bool any_inside = false;
  bool any_outside = false;
  for (auto voxel = grid.cbeginValueOn(); voxel && !(any_inside && any_outside); ++voxel) {
    (*voxel < 0.0F ? any_inside : any_outside) = true;
  }
  return any_inside && any_outside;
}

}  // namespace

FloatGrid::Ptr bake_sdf(const ScalarField& field, std::span<const Vec3> seeds_mm, double voxel_mm, BakeReport& report,
                        const Progress& progress) {
  constexpr double kFarthestSeedMm = 1e5;
  constexpr double kLongestWayMm = 300.0;  // from the seeds, along the surface: longer than any vertebra is round
  constexpr double kNearVoxels = 1.75;     // a cell that the surface cuts has its corners nearer than sqrt(3) voxels
  const auto band = static_cast<float>(kHalfWidthVoxels * voxel_mm);
  FloatGrid::Ptr grid = FloatGrid::create(band);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel_mm));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);

  auto wanted = std::make_shared<Mask>();
  {
    openvdb::tree::ValueAccessor<Mask> accessor(*wanted);
    for (const Vec3& p : seeds_mm) {
      if (!(p.array().abs() <= kFarthestSeedMm).all()) {
        fail("baking: expected seeds within ", kFarthestSeedMm, " mm of the origin, found ", p.transpose());
      }
      accessor.setValueOn(Coord::round(to_vdb(p / voxel_mm)));
    }
  }
  openvdb::tools::dilateActiveValues(*wanted, 1, openvdb::tools::NN_FACE_EDGE_VERTEX, openvdb::tools::IGNORE_TILES);

  // Each round evaluates the neighbours of the voxels near the surface, one voxel further, until all of those are
  // known.
  const int most_rounds = static_cast<int>(std::ceil(kLongestWayMm / voxel_mm));
  for (int round = 0;; ++round) {
    if (round == most_rounds) fail("baking: the zero set does not close within ", kLongestWayMm, " mm of the seeds");
    auto near = std::make_shared<Mask>();
    const std::size_t evaluated =
        evaluate_voxels(field, *wanted, voxel_mm, kNearVoxels * voxel_mm, *grid, *near, progress);
    report.evaluated_voxels += evaluated;
    if (evaluated == 0) break;
    openvdb::tools::dilateActiveValues(*near, 1, openvdb::tools::NN_FACE_EDGE_VERTEX, openvdb::tools::IGNORE_TILES);
    wanted = near;
  }

  for (auto voxel = grid->beginValueOn(); voxel; ++voxel) {
    const float value = *voxel;
    // Only the surface's own neighbourhood is kept; the rest is swept from it.
    if (std::abs(value) >= static_cast<float>(kNearVoxels * voxel_mm) * 1.25F) {
      voxel.setValue(value < 0.0F ? -band : band);
      voxel.setValueOff();
    }
  }
  if (!has_surface(*grid)) fail("baking: the field has no zero set near the ", seeds_mm.size(), " seeds");
  openvdb::tools::signedFloodFill(grid->tree());
  report.dropped_pieces = keep_one_piece(grid);

  progress.report("widening the band", 0.0);
  constexpr int kWiden = 3;  // where a piece was dropped beside it, a surface has but one voxel on each side
  grid = openvdb::tools::dilateSdf(*grid, kWiden, openvdb::tools::NN_FACE, 2);
  for (auto voxel = grid->beginValueOn(); voxel; ++voxel) {
    if (std::abs(*voxel) < band) continue;
    voxel.setValue(*voxel < 0.0F ? -band : band);
    voxel.setValueOff();
  }
  // The sweep leaves the largest distance that it met as the background.
  openvdb::tools::changeLevelSetBackground(grid->tree(), band);
  openvdb::tools::pruneLevelSet(grid->tree());
  openvdb::tools::signedFloodFill(grid->tree());
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setName("sdf");
  progress.report("widening the band", 1.0);
  return grid;
}

}  // namespace spinaltap::detail
