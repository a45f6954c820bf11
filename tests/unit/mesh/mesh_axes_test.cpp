#include "mesh/mesh_axes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "core/base/error.h"
#include "core/phantom/vertebra.h"
#include "mesh/mesh_quality.h"
#include "tests/support/filed_mesh.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/random_vertebra.h"
#include "tests/support/test_kind.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/isosurface.h"

namespace spinaltap {
namespace {

using test::filed_along;
using testing::HasSubstr;

TriangleMesh mesh_of(const Vertebra& vertebra) { return bone_surface(bake_solid(vertebra, {.voxel_mm = 1.0}, 40.0)); }

const TriangleMesh& phantom_mesh() {
  static const TriangleMesh mesh = mesh_of(Vertebra());
  return mesh;
}

SLOW_TESTS("MeshAxes.*");
WHOLE_RUNS("MeshAxes.AreFoundOfAPhantomInAll24");

TEST(MeshAxes, HaveTwentyFourRightHandedNames) {
  const auto& all = right_handed_axes();
  EXPECT_EQ(all.front(), "LPS");
  EXPECT_EQ(std::set<std::string>(all.begin(), all.end()).size(), 24U);
  for (const std::string& axes : all) {
    const Mat3 turn = lps_from_axes(axes);
    EXPECT_DOUBLE_EQ(turn.determinant(), 1.0) << axes;
    EXPECT_TRUE(turn.transpose() * turn == Mat3::Identity()) << axes;
  }
  // A file's x to the right, y to the front, z up: x and y change their signs.
  EXPECT_TRUE(lps_from_axes("RAS") == Mat3(Vec3(-1.0, -1.0, 1.0).asDiagonal()));
  // x to the front: what lies there has a negative y in LPS.
  EXPECT_TRUE(lps_from_axes("ALS") * Vec3::UnitX() == -Vec3::UnitY());
}

TEST(MeshAxes, AreRejectedWhereTheyAreNone) {
  for (const char* axes : {"", "LP", "LPSR", "LPX", "lps", "LRS", "LLS", "PPS", "SIA"}) {
    EXPECT_THROW(lps_from_axes(axes), Error) << axes;
  }
}

TEST(MeshAxes, AreTurnedToLps) {
  const TriangleMesh box = test::box_mesh({40.0F, 30.0F, 20.0F}, {5.0F, 6.0F, 7.0F});
  const double volume_mm3 = measure_mesh(box).volume_mm3;
  for (const char* axes : {"LPS", "RAS", "ALS", "PSL", "RPS", "LPI"}) {
    const TriangleMesh turned = turn_axes(box, axes);
    // Outward still, mirrored or not.
    EXPECT_NEAR(measure_mesh(turned).volume_mm3, volume_mm3, 1e-3) << axes;
  }
  EXPECT_EQ(turn_axes(filed_along(box, "SLP"), "SLP").vertices_mm, box.vertices_mm);
}

TEST(MeshAxes, AreFoundOfAPhantomInAll24) {
  for (const std::string& axes : right_handed_axes()) {
    const TriangleMesh filed = filed_along(phantom_mesh(), axes);
    const MeshAxes found = find_mesh_axes(filed);
    EXPECT_EQ(found.axes, axes);
    EXPECT_GE(found.sureness, 0.8) << axes;
    EXPECT_FALSE(found.is_inside_out) << axes;
    // Its own frame is LPS: within 15 degrees, a third of what would mistake an axis for another.
    const double near = std::cos(15.0 * kDegree);
    EXPECT_GT(Vec3(lps_from_axes(axes) * found.superior).z(), near) << axes;
    EXPECT_GT(Vec3(lps_from_axes(axes) * found.left).x(), near) << axes;
    EXPECT_EQ(turn_axes(filed, found.axes).vertices_mm, phantom_mesh().vertices_mm) << axes;
  }
}

TEST(MeshAxes, AreFoundOfRandomTiltedPhantoms) {
  // Sizes that differ, tilts of up to 20 degrees about any axis; axes by chance.
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const std::string& axes = right_handed_axes()[7 * seed % 24];
    const MeshAxes found = find_mesh_axes(filed_along(mesh_of(Vertebra(test::random_anatomy(seed))), axes));
    EXPECT_EQ(found.axes, axes) << "seed " << seed;
    EXPECT_GE(found.sureness, 0.5) << "seed " << seed;
  }
}

TEST(MeshAxes, AreCheckedWithAMessageThatSaysWhatToDo) {
  EXPECT_TRUE(check_mesh_axes(phantom_mesh()).empty());
  try {
    check_mesh_axes(filed_along(phantom_mesh(), "RAS"));
    FAIL() << "a half turn about the canal was not noticed";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("its axes look like RAS"));
    EXPECT_THAT(error.what(), HasSubstr("its canal runs along z"));
  }
  try {
    check_mesh_axes(filed_along(phantom_mesh(), "LSA"));
    FAIL() << "a canal along y was not noticed";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("its canal runs along y"));
    EXPECT_THAT(error.what(), HasSubstr("turn it from LSA"));
  }
}

TEST(MeshAxes, AreNotSeenToBeMirroredButForFacesThatWindInward) {
  // Mirrored with faces turned round, as a program does that knows of it, a vertebra looks like another's.
  EXPECT_TRUE(check_mesh_axes(turn_axes(phantom_mesh(), "RPS")).empty());
  // Without, its faces show it.
  const std::vector<std::string> warnings = check_mesh_axes(filed_along(phantom_mesh(), "RPS"));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0], HasSubstr("wind inward"));
}

TEST(MeshAxes, AreNotGuessedOfWhatIsNoVertebra) {
  EXPECT_THROW(find_mesh_axes(test::box_mesh({80.0F, 70.0F, 50.0F}, {0.0F, 0.0F, 0.0F})), Error);
}

TEST(MeshAxes, OfAnEvenRingHaveNoTop) {
  // A body, and an arch that is its own mirror image from top to bottom: a ring thicker at one side.
  TriangleMesh ring = test::torus_mesh(22.0, 8.0, 96, 48);
  for (Eigen::Vector3f& p : ring.vertices_mm) {
    if (p.y() < 0.0F) p.z() *= 1.0F - 0.03F * p.y();
    p.z() *= 1.6F;
  }
  const MeshAxes found = find_mesh_axes(ring);
  EXPECT_LT(found.sureness, 0.2);
  EXPECT_EQ(found.superior.cwiseAbs().maxCoeff(), std::abs(found.superior.z()));
}

}  // namespace
}  // namespace spinaltap
