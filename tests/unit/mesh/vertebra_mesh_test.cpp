#include "mesh/vertebra_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/base/error.h"
#include "tests/support/mesh_shapes.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// As large as a lumbar vertebra is.
TriangleMesh vertebra_box() { return test::box_mesh({84.0F, 79.0F, 52.0F}, {-120.0F, 30.0F, 400.0F}); }

std::string rejection(const TriangleMesh& mesh, Level level = Level::kNone) {
  try {
    check_mesh_units(mesh, level);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(MeshUnits, OfAVertebraInMillimetresAreAccepted) {
  EXPECT_EQ(rejection(vertebra_box()), "");
  EXPECT_EQ(rejection(vertebra_box(), *level_from_name("L3")), "");
  EXPECT_EQ(rejection(vertebra_box(), *level_from_name("T9")), "");
}

TEST(MeshUnits, AreNamedWhereTheyAreOthers) {
  EXPECT_THAT(rejection(scaled_mesh(vertebra_box(), 1e-3)),
              AllOf(HasSubstr("the mesh is 0.084 x 0.079 x 0.052; a vertebra is 35 to 135 mm"),
                    HasSubstr("it looks like metres: scale it by 1000")));
  EXPECT_THAT(rejection(scaled_mesh(vertebra_box(), 0.1)), HasSubstr("it looks like centimetres: scale it by 10"));
  EXPECT_THAT(rejection(scaled_mesh(vertebra_box(), 1.0 / 25.4), *level_from_name("L3")),
              AllOf(HasSubstr("L3 is 60 to 135 mm"), HasSubstr("it looks like inches: scale it by 25.4")));
}

TEST(MeshUnits, ThatMayBeTwoAreBothNamed) {
  // 4.5 cm are 45 mm, 4.5 inches 114 mm: a small cervical vertebra or a large lumbar one.
  const TriangleMesh mesh = test::box_mesh({4.5F, 4.0F, 2.5F}, {0.0F, 0.0F, 0.0F});
  EXPECT_THAT(rejection(mesh), HasSubstr("centimetres: scale it by 10, or inches: scale it by 25.4"));
  EXPECT_THAT(rejection(mesh, *level_from_name("C5")), testing::Not(HasSubstr("inches")));
}

TEST(MeshUnits, OfWhatIsNoVertebraAreNotGuessed) {
  // A whole lumbar spine.
  EXPECT_THAT(rejection(test::box_mesh({90.0F, 95.0F, 210.0F}, {0.0F, 0.0F, 0.0F})), HasSubstr("one whole vertebra?"));
  EXPECT_NE(rejection({}), "");
  TriangleMesh broken = vertebra_box();
  broken.vertices_mm[3].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(rejection(broken), HasSubstr("not a number"));
}

TEST(MeshUnits, ScaleAllCoordinates) {
  const TriangleMesh mesh = vertebra_box();
  const TriangleMesh back = scaled_mesh(scaled_mesh(mesh, 1e-3), mm_per_unit(*length_unit_from_name("m")));
  ASSERT_EQ(back.vertices_mm.size(), mesh.vertices_mm.size());
  for (std::size_t n = 0; n < mesh.vertices_mm.size(); ++n) {
    EXPECT_LE((back.vertices_mm[n] - mesh.vertices_mm[n]).norm(), 1e-4F);  // single precision at half a metre
  }
  EXPECT_EQ(back.triangles, mesh.triangles);
  EXPECT_THROW(scaled_mesh(mesh, 0.0), Error);
  EXPECT_THROW(scaled_mesh(mesh, std::numeric_limits<double>::quiet_NaN()), Error);
}

TEST(MeshUnits, HaveNames) {
  EXPECT_DOUBLE_EQ(mm_per_unit(*length_unit_from_name("mm")), 1.0);
  EXPECT_DOUBLE_EQ(mm_per_unit(*length_unit_from_name("cm")), 10.0);
  EXPECT_DOUBLE_EQ(mm_per_unit(*length_unit_from_name("in")), 25.4);
  EXPECT_DOUBLE_EQ(mm_per_unit(*length_unit_from_name("m")), 1000.0);
  EXPECT_FALSE(length_unit_from_name("furlong"));
}

}  // namespace
}  // namespace spinaltap
