#include "vdb/grid/bone_model.h"

#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/bone_samplers.h"
#include "vdb/grid/bone_field.h"

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
  samplers_ = std::make_shared<const detail::BoneSamplers>(detail::make_samplers(*grids_));
}

void BoneModel::sample(std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) const {
  samplers_->distance.linear(points_mm, distance_mm, {});
  if (!hu.empty()) samplers_->hu.linear(points_mm, hu, {});
}

void BoneModel::distance(std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<Vec3> gradients,
                         Interpolation interpolation) const {
  if (interpolation == Interpolation::linear) {
    samplers_->distance.linear(points_mm, distance_mm, gradients);
  } else {
    samplers_->distance.quadratic(points_mm, distance_mm, gradients);
  }
}

void BoneModel::hu(std::span<const Vec3> points_mm, std::span<float> hu, std::span<Vec3> gradients_hu_per_mm,
                   Interpolation interpolation) const {
  if (interpolation == Interpolation::linear) {
    samplers_->hu.linear(points_mm, hu, gradients_hu_per_mm);
  } else {
    samplers_->hu.quadratic(points_mm, hu, gradients_hu_per_mm);
  }
}

void BoneModel::normals(std::span<const Vec3> points_mm, std::span<Vec3> normals) const {
  constexpr double kMinSlope = 0.1;
  std::vector<float> unused(points_mm.size());
  samplers_->distance.quadratic(points_mm, std::span<float>(unused), normals);
  for (Vec3& normal : normals) {
    const double slope = normal.norm();
    normal = slope >= kMinSlope ? Vec3(normal / slope) : Vec3(Vec3::Zero());
  }
}

void BoneModel::inside(std::span<const Vec3> points_mm, std::span<std::uint8_t> inside) const {
  samplers_->distance.negative(points_mm, inside);
}

double BoneModel::band_mm() const { return static_cast<double>(grids_->sdf->background()); }

double BoneModel::voxel_mm() const { return grids_->sdf->voxelSize()[0]; }

Box3 BoneModel::bounds_mm() const { return detail::active_box_mm(*grids_->sdf); }

std::size_t BoneModel::active_voxels() const { return grids_->sdf->activeVoxelCount(); }

const std::map<std::string, std::string>& BoneModel::metadata() const { return grids_->metadata; }

bool is_drilled(const BoneModel& bone) { return bone.grids().hole != nullptr; }

BoneModel before_drilling(const BoneModel& bone) {
  if (!is_drilled(bone)) return bone;
  auto grids = std::make_shared<detail::BoneGrids>(bone.grids());
  grids->sdf = grids->before;
  grids->before.reset();
  grids->hole.reset();
  return BoneModel(grids);
}

void BoneField::evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                         std::span<Vec3> gradients) const {
  bone_.samplers().distance.quadratic(points_mm, values_mm, gradients);
}

void bone_density(const BoneModel& bone, const HuToDensity& line, std::span<const Vec3> points_mm,
                  std::span<float> density_g_cm3) {
  bone.hu(points_mm, density_g_cm3, {});
  for (float& value : density_g_cm3) value = static_cast<float>(line.density_g_cm3(static_cast<double>(value)));
}

CtVolume ct_of_bone(const BoneModel& bone, double voxel_mm) {
  constexpr double kMarginMm = 2.0;
  const Box3 bounds_mm = bone.bounds_mm();
  GridGeometry geometry;
  geometry.origin_mm = bounds_mm.min() - Vec3::Constant(kMarginMm);
  geometry.spacing_mm = Vec3::Constant(voxel_mm);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double side_mm = bounds_mm.sizes()[static_cast<Eigen::Index>(axis)] + 2.0 * kMarginMm;
    geometry.size[axis] = static_cast<int>(std::ceil(side_mm / voxel_mm)) + 1;
  }
  check_geometry(geometry, "the bone's CT", std::size_t{1} << 28);
  std::vector<std::int16_t> voxels(geometry.voxel_count());
  tbb::parallel_for(0, geometry.size[2], [&](int k) {
    std::vector<Vec3> row_mm(static_cast<std::size_t>(geometry.size[0]));
    std::vector<float> hu(row_mm.size());
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        row_mm[static_cast<std::size_t>(i)] = geometry.to_patient(Vec3(i, j, k));
      }
      bone.hu(row_mm, hu, {});
      std::transform(
          hu.begin(), hu.end(), voxels.begin() + static_cast<std::ptrdiff_t>(geometry.offset(0, j, k)),
          [](float value) { return static_cast<std::int16_t>(std::lround(std::clamp(value, -32768.0F, 32767.0F))); });
    }
  });
  return make_ct_volume(geometry, std::move(voxels));
}

}  // namespace spinaltap
