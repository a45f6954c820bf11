#include "vdb/bone_model.h"

#include <openvdb/tools/Interpolation.h>

#include "core/base/error.h"
#include "vdb/detail/bone_grids.h"

namespace spinaltap {
namespace detail {

Box3 active_box_mm(const openvdb::FloatGrid& grid) {
  const openvdb::CoordBBox voxels = grid.evalActiveVoxelBoundingBox();
  Box3 box;
  for (int corner = 0; corner < 8; ++corner) {
    const openvdb::Vec3d index((corner & 1) != 0 ? voxels.max().x() : voxels.min().x(),
                               (corner & 2) != 0 ? voxels.max().y() : voxels.min().y(),
                               (corner & 4) != 0 ? voxels.max().z() : voxels.min().z());
    box.extend(from_vdb(grid.indexToWorld(index)));
  }
  return box;
}

}  // namespace detail

BoneModel::BoneModel(std::shared_ptr<const detail::BoneGrids> grids) : grids_(std::move(grids)) {
  if (!grids_ || !grids_->sdf || !grids_->hu) fail("bone model: expected the grids sdf and hu");
}

void BoneModel::sample(std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) const {
  using Sampler = openvdb::tools::GridSampler<openvdb::FloatGrid::ConstAccessor, openvdb::tools::BoxSampler>;
  // Accessors belong to one thread: each call makes its own.
  const openvdb::FloatGrid::ConstAccessor sdf_accessor = grids_->sdf->getConstAccessor();
  const Sampler sdf(sdf_accessor, grids_->sdf->transform());
  for (std::size_t i = 0; i < points_mm.size(); ++i) distance_mm[i] = sdf.wsSample(detail::to_vdb(points_mm[i]));
  if (hu.empty()) return;
  const openvdb::FloatGrid::ConstAccessor hu_accessor = grids_->hu->getConstAccessor();
  const Sampler number(hu_accessor, grids_->hu->transform());
  for (std::size_t i = 0; i < points_mm.size(); ++i) hu[i] = number.wsSample(detail::to_vdb(points_mm[i]));
}

double BoneModel::band_mm() const { return static_cast<double>(grids_->sdf->background()); }

double BoneModel::voxel_mm() const { return grids_->sdf->voxelSize()[0]; }

Box3 BoneModel::bounds_mm() const { return detail::active_box_mm(*grids_->sdf); }

std::size_t BoneModel::active_voxels() const { return grids_->sdf->activeVoxelCount(); }

const std::map<std::string, std::string>& BoneModel::facts() const { return grids_->facts; }

}  // namespace spinaltap
