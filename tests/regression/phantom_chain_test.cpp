// A phantom's ground truth against what the whole chain makes of its CT: scan, DICOM, mask, surface points, radial
// basis function, grids, mesh.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/ct/dicom_read.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "mesh/display_mesh.h"
#include "mesh/mesh_quality.h"
#include "mesh/surface_comparison.h"
#include "tests/support/mesh_of_real_vertebra.h"
#include "tests/support/surface_distance.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_data.h"
#include "tests/support/test_kind.h"
#include "vdb/grid/isosurface.h"
#include "vdb/grid/mesh_solid.h"
#include "vdb/sim/bake_ct.h"
#include "vdb/sim/phantom_output.h"

namespace spinaltap {
namespace {

constexpr double kPixelMm = 0.352;

/// Bakes a phantom's CT and compares its surface with the ground truth, both ways: mean, 99 %, volume, roughness,
/// topology. `true_surface`: the isosurface of the solid itself.
void expect_chain_gives_back(const Solid& solid, const std::optional<VertebraGroundTruth>& ground_truth,
                             const TriangleMesh& true_surface, double true_volume_mm3) {
  const test::TemporaryFolder folder;
  PhantomOptions options;
  // The whole body and some tissue above and below.
  const double height_mm = solid.bounds_mm().sizes().z() + 6.0;
  options.scan.slices = std::max(options.scan.slices, static_cast<int>(height_mm / options.scan.slice_step_mm));
  write_phantom(solid, ground_truth, options, folder.path() / "phantom");
  const CtVolume ct = read_dicom(folder.path() / "phantom/ct");
  EXPECT_NEAR(ct.geometry.spacing_mm.x(), kPixelMm, 1e-9);
  const BakedCt baked = bake_ct(ct);
  EXPECT_EQ(baked.bake.dropped_pieces, 0U);
  const TriangleMesh mesh = bone_surface(baked.bone);

  const SurfaceError to_ground_truth = surface_error(mesh, solid);
  const std::vector<Vec3> true_points_mm = test::true_surface_points(solid, 0.5, 0.01);
  EXPECT_GT(true_points_mm.size(), 50000U);
  const test::DistanceFigures from_ground_truth = test::distance_to_bone(baked.bone, true_points_mm);
  std::printf("mean distance from surface to ground truth: %.4f mm (99%% %.3f, max %.3f, bias %.4f), %zu vertices\n",
              to_ground_truth.mean_mm, to_ground_truth.p99_mm, to_ground_truth.max_mm, to_ground_truth.bias_mm,
              mesh.vertices_mm.size());
  std::printf("mean distance from ground truth to surface: %.4f mm (99%% %.3f, max %.3f), %zu points\n",
              from_ground_truth.mean_mm, from_ground_truth.p99_mm, from_ground_truth.max_mm, true_points_mm.size());
  // A sixth of a pixel, and what no drilling would notice.
  EXPECT_LE(to_ground_truth.mean_mm, 0.06);
  EXPECT_LE(from_ground_truth.mean_mm, 0.06);
  EXPECT_LE(to_ground_truth.p99_mm, 0.25);
  EXPECT_LE(from_ground_truth.p99_mm, 0.25);
  const double true_roughness_deg = roughness_deg(true_surface);
  const double found_roughness_deg = roughness_deg(mesh);
  std::printf("roughness %.2f degrees, ground truth %.2f\n", found_roughness_deg, true_roughness_deg);
  EXPECT_LE(found_roughness_deg, 2.0 * true_roughness_deg);

  const MeshQuality quality = measure_mesh(mesh);
  std::printf("volume %.0f mm3, ground truth %.0f; pieces %zu, Euler number %ld, smallest angle %.1f degrees\n",
              quality.volume_mm3, true_volume_mm3, quality.pieces, quality.euler_number, quality.smallest_angle_deg);
  EXPECT_TRUE(quality.closed()) << quality.boundary_edges << " border edges, " << quality.rejected_faces << " rejected";
  EXPECT_EQ(quality.pieces, 1U);
  EXPECT_EQ(quality.euler_number, 0) << "one hole, the vertebral canal";
  EXPECT_NEAR(quality.volume_mm3, true_volume_mm3, 0.005 * true_volume_mm3);

  RemeshReport remeshed;
  const MeshQuality shown = measure_mesh(display_mesh(baked.bone, {}, &remeshed));
  std::printf(
      "display mesh: %zu triangles, smallest angle %.1f degrees, within %.3f mm of the surface, volume %.0f mm3\n",
      shown.triangles, shown.smallest_angle_deg, remeshed.to_surface.max_mm, shown.volume_mm3);
  EXPECT_TRUE(remeshed.reached);
  EXPECT_TRUE(shown.closed());
  EXPECT_EQ(shown.pieces, 1U);
  EXPECT_EQ(shown.euler_number, 0);
  EXPECT_EQ(remeshed.self_intersections, 0U);
  EXPECT_GE(shown.smallest_angle_deg, 15.0);
  EXPECT_NEAR(shown.volume_mm3, true_volume_mm3, 0.005 * true_volume_mm3);
}

WHOLE_RUNS("PhantomChain.*");

TEST(PhantomChain, GivesBackTheVertebra) {
  const Vertebra vertebra;
  const TriangleMesh true_surface = bone_surface(bake_solid(vertebra, {}, 40.0));
  expect_chain_gives_back(vertebra, vertebra_ground_truth(vertebra), true_surface,
                          measure_mesh(true_surface).volume_mm3);
}

TEST(PhantomChain, GivesBackTheMeshOfARealVertebra) {
  SPINALTAP_NEED_TEST_DATA(folder, "L3_mesh")
  const TriangleMesh mesh = test::read_real_vertebra(folder);
  const std::unique_ptr<Solid> solid = make_mesh_solid(mesh);
  expect_chain_gives_back(*solid, std::nullopt, bone_surface(bake_solid(*solid, {}, 40.0)),
                          std::abs(measure_mesh(mesh).volume_mm3));
}

}  // namespace
}  // namespace spinaltap
