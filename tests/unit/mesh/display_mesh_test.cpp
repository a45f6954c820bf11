#include "mesh/display_mesh.h"

#include <gtest/gtest.h>

#include "core/phantom/vertebra.h"
#include "mesh/mesh_quality.h"
#include "mesh/self_intersections.h"
#include "tests/support/test_kind.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/isosurface.h"

namespace spinaltap {
namespace {

SLOW_TESTS("DisplayMesh.*");

TEST(DisplayMesh, OfThePhantomVertebraIsGoodEverywhere) {
  const BoneModel bone = bake_solid(Vertebra(), {}, 40.0);
  RemeshReport report;
  const TriangleMesh mesh = display_mesh(bone, {}, &report);
  EXPECT_TRUE(report.reached);
  const MeshQuality quality = measure_mesh(mesh);
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.pieces, 1U);
  EXPECT_EQ(quality.euler_number, 0) << "one hole, the vertebral canal";
  EXPECT_GE(quality.smallest_angle_deg, 15.0);
  EXPECT_TRUE(self_intersections(mesh).empty());
  EXPECT_LE(report.to_surface.max_mm, 0.05);
  EXPECT_LE(report.from_surface.max_mm, 0.05);
  const TriangleMesh raw = bone_surface(bone);
  EXPECT_LT(10 * mesh.triangles.size(), raw.triangles.size());
  // Over the whole surface the mean distance is a fraction of the most.
  const MeshQuality raw_quality = measure_mesh(raw);
  EXPECT_NEAR(quality.volume_mm3, raw_quality.volume_mm3, 0.02 * raw_quality.area_mm2);
}

}  // namespace
}  // namespace spinaltap
