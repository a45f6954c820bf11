// The display mesh of a real vertebra, scanned as a mesh: SPINALTAP_TEST_DATA/L3_mesh.

#include <gtest/gtest.h>

#include <cstdio>

#include "mesh/display_mesh.h"
#include "mesh/mesh_quality.h"
#include "mesh/self_intersections.h"
#include "tests/support/mesh_of_real_vertebra.h"
#include "tests/support/test_data.h"
#include "tests/support/test_kind.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/isosurface.h"
#include "vdb/grid/mesh_solid.h"

namespace spinaltap {
namespace {

WHOLE_RUNS("RemeshRealVertebra.*");

TEST(RemeshRealVertebra, KeepsItsTopologyWithoutThinTriangles) {
  SPINALTAP_NEED_TEST_DATA(folder, "L3_mesh")
  const BoneModel bone = bake_solid(*make_mesh_solid(test::read_real_vertebra(folder)), {}, 40.0);
  RemeshReport report;
  const TriangleMesh mesh = display_mesh(bone, {}, &report);
  const MeshQuality start = measure_mesh(bone_surface(bone));
  const MeshQuality quality = measure_mesh(mesh);
  std::printf(
      "%zu to %zu triangles, smallest angle %.2f degrees, to surface %.4f mm, from surface %.4f mm, %zu rounds\n",
      start.triangles, quality.triangles, quality.smallest_angle_deg, report.to_surface.max_mm,
      report.from_surface.max_mm, report.rounds);
  // The mesh is made of facets: at its creases, which its distance has to the full, edges of half a voxel are too long.
  EXPECT_LE(report.to_surface.p99_mm, 0.05);
  EXPECT_LE(report.from_surface.p99_mm, 0.05);
  EXPECT_LE(report.to_surface.max_mm, 0.5 * bone.voxel_mm());
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.pieces, start.pieces);
  EXPECT_EQ(quality.euler_number, start.euler_number);
  EXPECT_GE(quality.smallest_angle_deg, 15.0);
  EXPECT_TRUE(self_intersections(mesh).empty());
}

}  // namespace
}  // namespace spinaltap
