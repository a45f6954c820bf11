// A phantom's truth against what the whole chain makes of its CT: scan, DICOM, mask, surface points, radial basis
// function, grids, mesh.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "apps/common/bake_ct.h"
#include "apps/common/phantom_output.h"
#include "apps/common/surface_error.h"
#include "core/ct/dicom_read.h"
#include "core/phantom/vertebra_truth.h"
#include "mesh/mesh_quality.h"
#include "tests/support/mesh_of_real_vertebra.h"
#include "tests/support/surface_distance.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_data.h"
#include "vdb/isosurface.h"
#include "vdb/mesh_solid.h"

namespace spinaltap {
namespace {

constexpr double kPixelMm = 0.352;

/// Bakes a phantom's CT and compares its surface with the truth, both ways. The project's promise is a mean below one
/// pixel; gross errors anywhere show in the 99%, below two.
BoneModel expect_chain_gives_back(const Solid& solid, const std::optional<VertebraTruth>& truth,
                                  double true_volume_mm3) {
  const test::TemporaryFolder folder;
  PhantomOptions options;
  // The whole body and some tissue above and below.
  const double height_mm = solid.bounds_mm().sizes().z() + 6.0;
  options.scan.slices = std::max(options.scan.slices, static_cast<int>(height_mm / options.scan.slice_step_mm));
  write_phantom(solid, truth, options, folder.path() / "phantom");
  const CtVolume ct = read_dicom(folder.path() / "phantom/ct");
  EXPECT_NEAR(ct.geometry.spacing_mm.x(), kPixelMm, 1e-9);
  const BakedCt baked = bake_ct(ct);
  EXPECT_EQ(baked.bake.dropped_pieces, 0U);
  const TriangleMesh mesh = bone_surface(baked.bone);

  const SurfaceError to_truth = surface_error(mesh, solid);
  const std::vector<Vec3> true_points_mm = test::true_surface_points(solid, 0.5, 0.01);
  EXPECT_GT(true_points_mm.size(), 50000U);
  const test::DistanceFigures from_truth = test::distance_to_bone(baked.bone, true_points_mm);
  std::printf("mean distance from surface to truth: %.4f mm (99%% %.3f, most %.3f, bias %.4f), %zu vertices\n",
              to_truth.mean_mm, to_truth.p99_mm, to_truth.max_mm, to_truth.bias_mm, mesh.vertices_mm.size());
  std::printf("mean distance from truth to surface: %.4f mm (99%% %.3f, most %.3f), %zu points\n", from_truth.mean_mm,
              from_truth.p99_mm, from_truth.max_mm, true_points_mm.size());
  EXPECT_LT(to_truth.mean_mm, kPixelMm);
  EXPECT_LT(from_truth.mean_mm, kPixelMm);
  EXPECT_LT(to_truth.p99_mm, 2.0 * kPixelMm);
  EXPECT_LT(from_truth.p99_mm, 2.0 * kPixelMm);

  const MeshQuality quality = measure_mesh(mesh);
  std::printf("volume %.0f mm3, truth %.0f; pieces %zu, Euler number %ld, smallest angle %.1f degrees\n",
              quality.volume_mm3, true_volume_mm3, quality.pieces, quality.euler_number, quality.smallest_angle_deg);
  EXPECT_TRUE(quality.closed()) << quality.boundary_edges << " border edges, " << quality.refused_faces << " refused";
  EXPECT_EQ(quality.pieces, 1U);
  // A tenth of a millimetre over the whole surface is about 3% of a vertebra.
  EXPECT_NEAR(quality.volume_mm3, true_volume_mm3, 0.05 * true_volume_mm3);
  return baked.bone;
}

TEST(PhantomChain, GivesBackTheVertebra) {
  const Vertebra vertebra;
  const double true_volume_mm3 = measure_mesh(bone_surface(bake_solid(vertebra, {}, 40.0))).volume_mm3;
  const BoneModel bone = expect_chain_gives_back(vertebra, vertebra_truth(vertebra), true_volume_mm3);
  // One hole, the vertebral canal.
  EXPECT_EQ(measure_mesh(bone_surface(bone)).euler_number, 0);
}

TEST(PhantomChain, GivesBackTheMeshOfARealVertebra) {
  SPINALTAP_NEED_TEST_DATA(folder, "L3_mesh")
  const TriangleMesh mesh = test::read_real_vertebra(folder);
  const std::unique_ptr<Solid> solid = make_mesh_solid(mesh);
  expect_chain_gives_back(*solid, std::nullopt, std::abs(measure_mesh(mesh).volume_mm3));
}

}  // namespace
}  // namespace spinaltap
