// Landmarks of surfaces of real lumbar vertebrae: each is scanned alone, its CT baked, and what is found compared with
// the mesh's own triangles. See tests/support/test_data.h for where the meshes lie.

#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "core/anatomy/bone_shape.h"
#include "core/phantom/scanner.h"
#include "core/rbf/fit_surface.h"
#include "core/surface/surface_points.h"
#include "tests/support/mesh_landmarks.h"
#include "tests/support/real_meshes.h"
#include "tests/support/test_kind.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/bone_field.h"
#include "vdb/grid/bone_model.h"
#include "vdb/grid/mesh_solid.h"

namespace spinaltap {
namespace {

CtVolume scan_alone(const Solid& solid) {
  constexpr double kMarginMm = 10.0;
  ScanOptions options;
  options.pixel_mm = 0.5;
  options.slice_step_mm = 0.7;
  options.noise_hu = 12.0;
  const Vec3 sides_mm = solid.bounds_mm().sizes() + Vec3::Constant(2.0 * kMarginMm);
  options.columns = static_cast<int>(sides_mm.x() / options.pixel_mm);
  options.rows = static_cast<int>(sides_mm.y() / options.pixel_mm);
  options.slices = static_cast<int>(sides_mm.z() / options.slice_step_mm);
  return scan(solid, options);
}

/// The voxels whose centres lie in the body: what a flawless segmentation would find.
BoneMask true_mask(const Solid& solid, const GridGeometry& geometry) {
  BoneMask mask{geometry, {}};
  mask.inside.reserve(geometry.voxel_count());
  std::vector<Vec3> row_mm(static_cast<std::size_t>(geometry.size[0]));
  std::vector<double> values_mm(row_mm.size());
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i)
        row_mm[static_cast<std::size_t>(i)] = geometry.to_patient(Vec3(i, j, k));
      solid.evaluate(row_mm, values_mm, {});
      for (const double value_mm : values_mm) mask.inside.push_back(value_mm < 0.0 ? 1 : 0);
    }
  }
  return mask;
}

Landmarks landmarks_through_a_ct(const TriangleMesh& mesh) {
  const std::unique_ptr<Solid> solid = make_mesh_solid(mesh, {.voxel_mm = 0.3});
  const CtVolume ct = scan_alone(*solid);
  const SurfacePoints surface = extract_surface(ct, true_mask(*solid, ct.geometry));
  const SurfaceFit fit = fit_surface(surface, {.spacing_mm = 0.8});
  const BoneModel bone = bake_bone(fit.field, surface.positions_mm, ct, {.voxel_mm = 0.4}, {});
  return find_landmarks(BoneShape(std::make_shared<BoneField>(bone), bone.bounds_mm(), bone.voxel_mm()));
}

class LandmarksOfRealMeshes : public testing::TestWithParam<std::size_t> {};

WHOLE_RUNS("LandmarksOfRealMeshes.*");

TEST_P(LandmarksOfRealMeshes, AreThoseOfTheMesh) {
  const test::RealMesh real = test::real_meshes()[GetParam()];
  SPINALTAP_NEED_TEST_DATA(file, real.file)
  const TriangleMesh mesh = test::read_in_lps(real);
  const Landmarks found = landmarks_through_a_ct(mesh);
  std::printf("%s\n", real.name);
  test::expect_landmarks_of(mesh, found);
  test::expect_usual(found);
}

INSTANTIATE_TEST_SUITE_P(All, LandmarksOfRealMeshes, testing::Range(std::size_t{0}, test::real_meshes().size()),
                         test::name_of_real_mesh);

}  // namespace
}  // namespace spinaltap
