// Units and axes of surface files that the phantom command scans, from the command line.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "core/phantom/vertebra.h"
#include "mesh/mesh_io.h"
#include "mesh/vertebra_mesh.h"
#include "tests/cli/program.h"
#include "tests/support/filed_mesh.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/temporary_folder.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/isosurface.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;

constexpr const char* kCoarse =
    " --pixel 1.5 --size 80 --slices 30 --slice-step 3 --slice-width 3 --ground-truth-voxel 1";

test::ProgramRun scan_of(const TriangleMesh& mesh, const std::string& options) {
  const test::TemporaryFolder folder;
  write_mesh(mesh, folder.path() / "mesh.stl");
  return test::run_program("phantom scanned --mesh mesh.stl " + options + kCoarse, folder.path());
}

TEST(MeshInput, IsRejectedInMetresAndAlongOtherAxesUntilTheyAreSaid) {
  const TriangleMesh vertebra = bone_surface(bake_solid(Vertebra(), {.voxel_mm = 1.0}, 40.0));
  EXPECT_EQ(scan_of(vertebra, "").exit_code, 0);

  const TriangleMesh in_metres_and_ras = scaled_mesh(test::filed_along(vertebra, "RAS"), 1e-3);
  const test::ProgramRun unit = scan_of(in_metres_and_ras, "");
  EXPECT_NE(unit.exit_code, 0);
  EXPECT_THAT(unit.errors, HasSubstr("it looks like metres"));
  const test::ProgramRun axes = scan_of(in_metres_and_ras, "--units m");
  EXPECT_NE(axes.exit_code, 0);
  EXPECT_THAT(axes.errors, HasSubstr("its axes look like RAS"));
  const test::ProgramRun both = scan_of(in_metres_and_ras, "--units m --axes RAS");
  EXPECT_EQ(both.exit_code, 0) << both.errors;
}

TEST(MeshInput, IsAnyClosedMeshWhereBothAreSaid) {
  const TriangleMesh box = test::box_mesh({40.0F, 30.0F, 20.0F}, {0.0F, 0.0F, 0.0F});
  EXPECT_NE(scan_of(box, "").exit_code, 0);
  const test::ProgramRun taken = scan_of(box, "--units mm --axes LPS");
  EXPECT_EQ(taken.exit_code, 0) << taken.errors;
  EXPECT_THAT(scan_of(box, "--units mm --axes RAX").errors, HasSubstr("expected three letters"));
}

}  // namespace
}  // namespace spinaltap
