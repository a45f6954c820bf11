#include "vdb/bake/bake.h"

#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/error.h"
#include "core/base/version.h"
#include "core/phantom/surface_seeds.h"
#include "core/segment/distance_transform.h"
#include "vdb/bake/detail/bake_sdf.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/vdb_file.h"

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

openvdb::FloatGrid::Ptr bake_hu(const openvdb::FloatGrid& sdf, const GridGeometry& geometry, double margin_mm,
                                const HuOfVoxel& hu) {
  constexpr float kAirHu = -1024.0F;
  auto grid = openvdb::FloatGrid::create(kAirHu);
  grid->setTransform(transform_of(geometry));
  grid->setName("hu");

  // The part of the grid that the level set and the margin can reach.
  const double reach_mm = margin_mm + geometry.spacing_mm.norm();
  Box3 box_index;
  const Box3 box_mm = active_box_mm(sdf);
  for (int corner = 0; corner < 8; ++corner) {
    box_index.extend(geometry.to_index(box_mm.corner(static_cast<Box3::CornerType>(corner))));
  }
  GridGeometry part = geometry;
  std::array<int, 3> low{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    const double reach_index = reach_mm / geometry.spacing_mm[at];
    const double last = geometry.size[axis] - 1;
    low[axis] = static_cast<int>(std::clamp(std::floor(box_index.min()[at] - reach_index), 0.0, last + 1.0));
    const int high = static_cast<int>(std::clamp(std::ceil(box_index.max()[at] + reach_index), -1.0, last));
    part.size[axis] = std::max(0, high - low[axis] + 1);
  }
  if (part.voxel_count() == 0) return grid;
  part.origin_mm = geometry.to_patient(Vec3(low[0], low[1], low[2]));

  // Its voxels within the level set's band or inside it, and those that are near to one: no further than the margin and
  // a voxel's diagonal, so that whole cells reach the margin.
  const openvdb::FloatGrid::ConstAccessor sdf_accessor = sdf.getConstAccessor();
  const openvdb::tools::GridSampler<openvdb::FloatGrid::ConstAccessor, openvdb::tools::PointSampler> distance(
      sdf_accessor, sdf.transform());
  std::vector<std::uint8_t> in_bone;
  in_bone.reserve(part.voxel_count());
  for (int k = 0; k < part.size[2]; ++k) {
    for (int j = 0; j < part.size[1]; ++j) {
      for (int i = 0; i < part.size[0]; ++i) {
        const float value = distance.wsSample(to_vdb(part.to_patient(Vec3(i, j, k))));
        in_bone.push_back(value < sdf.background() ? 1 : 0);
      }
    }
  }
  // The numbers take the distances' place; where there is none, nothing is stored.
  constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> numbers = squared_distance_to(in_bone, part);
  tbb::parallel_for(0, part.size[2], [&](int k) {
    for (int j = 0; j < part.size[1]; ++j) {
      for (int i = 0; i < part.size[0]; ++i) {
        float& number = numbers[part.offset(i, j, k)];
        const bool is_near = static_cast<double>(number) <= reach_mm * reach_mm;
        number = is_near ? rounded_to_half(hu(low[0] + i, low[1] + j, low[2] + k)) : kNoNumber;
      }
    }
  });
  auto accessor = grid->getAccessor();
  for (int k = 0; k < part.size[2]; ++k) {
    for (int j = 0; j < part.size[1]; ++j) {
      for (int i = 0; i < part.size[0]; ++i) {
        const float number = numbers[part.offset(i, j, k)];
        if (!std::isnan(number)) accessor.setValue(openvdb::Coord(low[0] + i, low[1] + j, low[2] + k), number);
      }
    }
  }
  return grid;
}

}  // namespace detail

namespace {

void check_options(const BakeOptions& options) {
  constexpr double kSmallestVoxelMm = 0.02;
  constexpr double kLargestVoxelMm = 5.0;
  if (!(options.voxel_mm >= kSmallestVoxelMm && options.voxel_mm <= kLargestVoxelMm)) {
    fail("baking: expected voxels of ", kSmallestVoxelMm, " to ", kLargestVoxelMm, " mm, found ", options.voxel_mm);
  }
  if (!(options.hu_margin_mm >= 0.0 && options.hu_margin_mm <= 100.0)) {
    fail("baking: expected a margin of 0 to 100 mm, found ", options.hu_margin_mm);
  }
}

}  // namespace

BoneModel bake_bone(const ScalarField& field, std::span<const Vec3> seeds_mm, const CtVolume& ct,
                    const BakeOptions& options, const std::map<std::string, std::string>& metadata, BakeReport* report,
                    const Progress& progress) {
  initialize_openvdb();
  check_options(options);
  BakeReport own_report;
  auto grids = std::make_shared<detail::BoneGrids>();
  grids->sdf = detail::bake_sdf(field, seeds_mm, options.voxel_mm, own_report, progress);
  grids->hu = detail::bake_hu(*grids->sdf, ct.geometry, options.hu_margin_mm,
                              [&](int i, int j, int k) { return static_cast<float>(ct.at(i, j, k)); });
  grids->metadata = metadata;
  if (report != nullptr) *report = own_report;
  return BoneModel(grids);
}

BoneModel bake_solid(const Solid& solid, const BakeOptions& options, double surroundings_hu, const Progress& progress,
                     const std::map<std::string, std::string>& metadata) {
  initialize_openvdb();
  check_options(options);
  BakeReport report;
  auto grids = std::make_shared<detail::BoneGrids>();
  grids->sdf = detail::bake_sdf(solid, surface_seeds(solid, options.voxel_mm), options.voxel_mm, report, progress);
  GridGeometry geometry;
  geometry.spacing_mm = Vec3::Constant(options.voxel_mm);
  const double margin_mm = options.hu_margin_mm + 2.0 * options.voxel_mm;
  geometry.origin_mm = solid.bounds_mm().min() - Vec3::Constant(margin_mm);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double extent_mm = solid.bounds_mm().sizes()[static_cast<Eigen::Index>(axis)] + 2.0 * margin_mm;
    geometry.size[axis] = static_cast<int>(std::ceil(extent_mm / options.voxel_mm)) + 1;
  }
  check_geometry(geometry, "ground truth grid");
  grids->hu = detail::bake_hu(*grids->sdf, geometry, options.hu_margin_mm, [&](int i, int j, int k) {
    const Vec3 p_mm = geometry.to_patient(Vec3(i, j, k));
    double distance_mm = 0.0;
    solid.evaluate({&p_mm, 1}, {&distance_mm, 1}, {});
    const double hu = distance_mm < 0.0 ? solid.hu(p_mm, distance_mm, options.voxel_mm) : surroundings_hu;
    return static_cast<float>(hu);
  });
  grids->metadata = metadata;
  grids->metadata.insert({{"program", version()}, {"method", "ground truth of a phantom"}});
  return BoneModel(grids);
}

}  // namespace spinaltap
