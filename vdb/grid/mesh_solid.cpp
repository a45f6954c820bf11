#include "vdb/grid/mesh_solid.h"

#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/lerp.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/vdb_file.h"

namespace spinaltap {
namespace {

using Sampler = openvdb::tools::GridSampler<openvdb::FloatGrid::ConstAccessor, openvdb::tools::BoxSampler>;

class MeshSolid final : public Solid {
 public:
  MeshSolid(openvdb::FloatGrid::ConstPtr grid, const Box3& bounds_mm, const MeshSolidOptions& options)
      : grid_(std::move(grid)), bounds_mm_(bounds_mm), options_(options) {}

  Box3 bounds_mm() const override { return bounds_mm_; }

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                std::span<Vec3> gradients) const override {
    const openvdb::FloatGrid::ConstAccessor accessor = grid_->getConstAccessor();
    const Sampler sampler(accessor, grid_->transform());
    const auto value = [&](const Vec3& p_mm) { return static_cast<double>(sampler.wsSample(detail::to_vdb(p_mm))); };
    const double step_mm = 0.5 * grid_->voxelSize()[0];
    for (std::size_t i = 0; i < points_mm.size(); ++i) {
      values_mm[i] = value(points_mm[i]);
      if (gradients.empty()) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = step_mm * Vec3::Unit(axis);
        gradients[i][axis] = (value(points_mm[i] + step) - value(points_mm[i] - step)) / (2.0 * step_mm);
      }
    }
  }

  double hu(const Vec3&, double distance_mm, double aperture_mm) const override {
    // The share of the aperture that lies in the shell.
    const double in_core = std::clamp(0.5 - (distance_mm + options_.cortex_mm) / aperture_mm, 0.0, 1.0);
    return lerp(options_.cortex_hu, options_.trabecular_hu, in_core);
  }

 private:
  openvdb::FloatGrid::ConstPtr grid_;
  Box3 bounds_mm_;
  MeshSolidOptions options_;
};

}  // namespace

std::unique_ptr<Solid> make_mesh_solid(const TriangleMesh& mesh, const MeshSolidOptions& options) {
  constexpr double kLargestMm = 1000.0;
  constexpr double kBandMm = 2.5;  // Solid promises a distance within 2 mm of the surface
  initialize_openvdb();
  if (mesh.triangles.empty()) fail("mesh phantom: the mesh has no triangles");
  if (!(options.voxel_mm >= 0.02 && options.voxel_mm <= 2.0)) {
    fail("mesh phantom: expected voxels of 0.02 to 2 mm, found ", options.voxel_mm);
  }
  const auto transform = openvdb::math::Transform::createLinearTransform(options.voxel_mm);
  Box3 bounds_mm;
  std::vector<openvdb::Vec3s> points;
  for (const Eigen::Vector3f& p : mesh.vertices_mm) {
    if (!p.allFinite()) fail("mesh phantom: a vertex is not a number");
    bounds_mm.extend(p.cast<double>());
    points.emplace_back(p.x(), p.y(), p.z());
    points.back() = openvdb::Vec3s(transform->worldToIndex(points.back()));
  }
  if (!(bounds_mm.sizes().maxCoeff() <= kLargestMm)) {
    fail("mesh phantom: expected at most ", kLargestMm, " mm (are its units mm?), found ",
         bounds_mm.sizes().maxCoeff());
  }
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t corner : t) {
      if (corner >= points.size()) fail("mesh phantom: vertex ", corner, " of ", points.size());
    }
    triangles.emplace_back(t[0], t[1], t[2]);
  }
  const auto band_voxels = static_cast<float>(kBandMm / options.voxel_mm);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(points, triangles);
  const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(adapter, *transform, band_voxels, band_voxels);
  return std::make_unique<MeshSolid>(grid, bounds_mm, options);
}

}  // namespace spinaltap
