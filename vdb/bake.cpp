#include "vdb/bake.h"

#include <openvdb/math/Half.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/Morphology.h>
#include <openvdb/tools/Prune.h>

#include <cmath>

#include "core/base/error.h"
#include "vdb/detail/bake_sdf.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/initialize.h"

namespace spinaltap {
namespace detail {
namespace {

openvdb::math::Transform::Ptr transform_of(const GridGeometry& geometry) {
  const Mat3 axes = geometry.index_to_patient_matrix();
  openvdb::Mat4d matrix = openvdb::Mat4d::identity();
  // OpenVDB multiplies row vectors: the steps of i, j and k are the rows.
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) matrix[row][column] = axes(column, row);
  }
  for (int column = 0; column < 3; ++column) matrix[3][column] = geometry.origin_mm[column];
  return openvdb::math::Transform::createLinearTransform(matrix);
}

}  // namespace

openvdb::FloatGrid::Ptr bake_hu(const openvdb::FloatGrid& sdf, const CtVolume& ct, double margin_mm) {
  constexpr float kAirHu = -1024.0F;
  const GridGeometry& geometry = ct.geometry;
  const auto grid = openvdb::FloatGrid::create(kAirHu);
  grid->setTransform(transform_of(geometry));
  grid->setName("hu");

  // The CT's voxels within the level set's band or inside it ...
  openvdb::MaskTree kept;
  openvdb::tree::ValueAccessor<openvdb::MaskTree> kept_accessor(kept);
  const openvdb::FloatGrid::ConstAccessor sdf_accessor = sdf.getConstAccessor();
  const openvdb::tools::GridSampler<openvdb::FloatGrid::ConstAccessor, openvdb::tools::PointSampler> distance(
      sdf_accessor, sdf.transform());
  Box3 box_index;
  const Box3 box_mm = active_box_mm(sdf);
  for (int corner = 0; corner < 8; ++corner) {
    box_index.extend(geometry.to_index(box_mm.corner(static_cast<Box3::CornerType>(corner))));
  }
  const auto low = [&](int axis) { return std::max(0, static_cast<int>(std::floor(box_index.min()[axis]))); };
  const auto high = [&](int axis) {
    return std::min(geometry.size[static_cast<std::size_t>(axis)] - 1,
                    static_cast<int>(std::ceil(box_index.max()[axis])));
  };
  for (int k = low(2); k <= high(2); ++k) {
    for (int j = low(1); j <= high(1); ++j) {
      for (int i = low(0); i <= high(0); ++i) {
        if (distance.wsSample(to_vdb(geometry.to_patient(Vec3(i, j, k)))) < sdf.background()) {
          kept_accessor.setValueOn(openvdb::Coord(i, j, k));
        }
      }
    }
  }
  // ... and the margin around them.
  const int margin = static_cast<int>(std::ceil(margin_mm / geometry.smallest_spacing_mm()));
  openvdb::tools::dilateActiveValues(kept, margin, openvdb::tools::NN_FACE, openvdb::tools::IGNORE_TILES);
  auto accessor = grid->getAccessor();
  for (auto voxel = kept.cbeginValueOn(); voxel; ++voxel) {
    openvdb::CoordBBox box;
    voxel.getBoundingBox(box);
    for (auto at = box.begin(); at; ++at) {
      const openvdb::Coord& c = *at;
      if (!geometry.contains(c.x(), c.y(), c.z())) continue;
      accessor.setValue(c, static_cast<float>(openvdb::math::half(static_cast<float>(ct.at(c.x(), c.y(), c.z())))));
    }
  }
  return grid;
}

}  // namespace detail

BoneModel bake_bone(const ScalarField& field, std::span<const Vec3> seeds_mm, const CtVolume& ct,
                    const BakeOptions& options, const std::map<std::string, std::string>& facts, BakeReport* report,
                    const Progress& progress) {
  constexpr double kSmallestVoxelMm = 0.02;
  constexpr double kLargestVoxelMm = 5.0;
  initialize_openvdb();
  if (!(options.voxel_mm >= kSmallestVoxelMm && options.voxel_mm <= kLargestVoxelMm)) {
    fail("baking: expected voxels of ", kSmallestVoxelMm, " to ", kLargestVoxelMm, " mm, found ", options.voxel_mm);
  }
  if (!(options.hu_margin_mm >= 0.0 && options.hu_margin_mm <= 100.0)) {
    fail("baking: expected a margin of 0 to 100 mm, found ", options.hu_margin_mm);
  }
  BakeReport own_report;
  auto grids = std::make_shared<detail::BoneGrids>();
  grids->sdf = detail::bake_sdf(field, seeds_mm, options.voxel_mm, own_report, progress);
  grids->hu = detail::bake_hu(*grids->sdf, ct, options.hu_margin_mm);
  grids->facts = facts;
  if (report != nullptr) *report = own_report;
  return BoneModel(grids);
}

}  // namespace spinaltap
