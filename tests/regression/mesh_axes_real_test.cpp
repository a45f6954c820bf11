// Units and axes of surfaces of real vertebrae, found by their shape.

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "core/base/error.h"
#include "mesh/vertebra_mesh.h"
#include "tests/support/filed_mesh.h"
#include "tests/support/real_meshes.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

class RealMeshAxes : public testing::TestWithParam<std::size_t> {};

WHOLE_RUNS("RealMeshAxes.*");

TEST_P(RealMeshAxes, AreFound) {
  const test::RealMesh real = test::real_meshes()[GetParam()];
  SPINALTAP_NEED_TEST_DATA(file, real.file)
  const TriangleMesh filed = test::read_as_filed(real);
  EXPECT_NO_THROW(check_mesh_units(filed, real.level));
  EXPECT_THROW(check_mesh_units(scaled_mesh(filed, 1e-3), real.level), Error);
  EXPECT_THROW(check_mesh_units(scaled_mesh(filed, 0.1), real.level), Error);
  const MeshAxes found = find_mesh_axes(filed);
  std::printf("%s: %s, sureness %.2f, drop %.2f, canal of radius %.1f mm\n", real.name, found.axes.c_str(),
              found.sureness, found.drop, found.canal_radius_mm);
  EXPECT_EQ(found.axes, real.axes);
  EXPECT_GE(found.sureness, 0.8);
  // The half turn that RAS is, and two others that differ from mesh to mesh.
  const TriangleMesh in_lps = test::read_in_lps(real);
  const auto& all = right_handed_axes();
  for (const std::string& axes :
       {std::string("RAS"), all[(5 * GetParam() + 3) % 24], all[(7 * GetParam() + 14) % 24]}) {
    EXPECT_EQ(find_mesh_axes(test::filed_along(in_lps, axes)).axes, axes);
  }
}

TEST_P(RealMeshAxes, AreCheckedWhenAFileIsRead) {
  const test::RealMesh real = test::real_meshes()[GetParam()];
  SPINALTAP_NEED_TEST_DATA(file, real.file)
  if (std::string(real.axes) != "LPS") {
    EXPECT_THROW(read_vertebra_mesh(file), Error);
  }
  const VertebraMesh read = read_vertebra_mesh(file, {.axes = real.axes, .level = real.level});
  EXPECT_EQ(read.mesh.vertices_mm, test::read_in_lps(real).vertices_mm);
  EXPECT_TRUE(to_vertebra_mesh(read.mesh).warnings.empty());
}

INSTANTIATE_TEST_SUITE_P(All, RealMeshAxes, testing::Range(std::size_t{0}, test::real_meshes().size()),
                         test::name_of_real_mesh);

}  // namespace
}  // namespace spinaltap
