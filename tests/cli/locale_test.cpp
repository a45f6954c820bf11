// Numbers under a locale with decimal commas: what the library reads and writes within a host that has taken that
// locale, and the program under it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "apps/report/text.h"
#include "core/base/staged_output.h"
#include "core/ct/dicom_write.h"
#include "core/ct/label_map.h"
#include "core/ct/read_ct.h"
#include "core/files/plan_file.h"
#include "core/session/depth_log.h"
#include "mesh/mesh_io.h"
#include "tests/cli/bone_ball.h"
#include "tests/cli/program.h"
#include "tests/support/error_of.h"
#include "tests/support/german_locale.h"
#include "tests/support/mesh_shapes.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

using Files = std::map<std::string, std::string>;

Files files_in(const fs::path& folder) {
  Files files;
  for (const std::string& name : test::everything_in(folder)) {
    if (fs::is_regular_file(folder / name)) files[name] = read_whole_file(folder / name);
  }
  return files;
}

void expect_same(const Files& found, const Files& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [name, bytes] : expected) {
    ASSERT_TRUE(found.contains(name)) << name;
    EXPECT_TRUE(found.at(name) == bytes) << name;
  }
}

/// What the library writes, and says, of numbers with fractions and of more than 1,000; and what it reads of that
/// again.
Files work_of_the_library() {
  const test::TemporaryFolder folder;
  GridGeometry geometry;
  geometry.size = {12, 10, 3};
  geometry.spacing_mm = Vec3(0.352, 0.352, 1.25);
  geometry.origin_mm = Vec3(-1234.5, 0.1, 1e-3);
  fs::create_directory(folder.path() / "ct");
  write_dicom(make_ct_volume(geometry, std::vector<std::int16_t>(geometry.voxel_count(), 1200)), folder.path() / "ct");
  EXPECT_LT((read_ct(folder.path() / "ct").geometry.spacing_mm - geometry.spacing_mm).norm(), 1e-12);

  BoneMask mask{geometry, std::vector<std::uint8_t>(geometry.voxel_count(), 0)};
  mask.inside[55] = 1;
  write_whole_file(folder.path() / "mask.nrrd", encode_label_map(mask, 1234, "mask.nrrd"));
  EXPECT_EQ(read_label_map(folder.path() / "mask.nrrd", 1234, geometry).inside, mask.inside);

  const DrillPath path{"left", Vec3(0.5, 1.25, -3.75), Vec3(1234.5, 1.0, 2.0) / 40.0, DrillBit{2.5, 30.0, 2.0}};
  write_plan({path}, folder.path() / "plan.json");
  EXPECT_EQ(read_plan(folder.path() / "plan.json").front().entry_mm, path.entry_mm);

  const TriangleMesh mesh = test::ball_mesh(6.125, Vec3(1234.5, -0.25, 0.0), 8, 12);
  write_mesh(mesh, folder.path() / "ball.obj");
  EXPECT_EQ(read_mesh(folder.path() / "ball.obj").vertices_mm.size(), mesh.vertices_mm.size());

  test::write_bone_ball(folder.path() / "bone.vdb");
  const Vec3 middle_mm = read_bone(folder.path() / "bone.vdb").bounds_mm().center();
  EXPECT_LT((middle_mm - test::kBoneCentre).norm(), 0.5);

  DepthRow row;
  row.depth_mm = 12.5;
  row.cycles = 12345;
  row.cycles_per_s = 1234.5;
  write_whole_file(folder.path() / "log.csv", log_csv({row}));
  write_whole_file(folder.path() / "words.txt",
                   test::error_of([] { fail("expected ", 1234567, " values of ", 0.5, " mm, found ", 1e-4); }) +
                       readable_number(12345.678, 2) + svg_number(0.25));
  return files_in(folder.path());
}

TEST(Locale, IsNothingToTheLibraryWithinAHostThatHasTakenOne) {
  const test::GermanLocale german;
  SPINALTAP_NEED_GERMAN(german);
  const Files plain = work_of_the_library();
  const test::GermanHost host(german);
  ASSERT_TRUE(host.is_german());
  char comma[32];
  std::snprintf(comma, sizeof comma, "%.1f", 0.5);
  ASSERT_STREQ(comma, "0,5");  // what printf() does to numbers here
  expect_same(work_of_the_library(), plain);
}

TEST(Locale, IsNothingToTheProgram) {
  const test::GermanLocale german;
  SPINALTAP_NEED_GERMAN(german);
  const auto work_under = [&](const std::string& locale) {
    const test::TemporaryFolder folder;
    test::write_bone_ball(folder.path() / "bone.vdb");
    const Vec3 direction = Vec3(1.0, 2.0, -2.0) / 3.0;
    write_plan({{"through", test::kBoneCentre - test::kBoneRadiusMm * direction,
                 test::kBoneCentre + test::kBoneRadiusMm * direction, DrillBit{2.0, 30.0, 2.0}}},
               folder.path() / "plan.json");
    const std::string before = "LC_ALL=" + locale + " LOCPATH='" + german.path() + "'";
    Files said;
    for (const std::string arguments :
         {"phantom l3 --pixel 1.6 --size 80 --slice-step 3.5 --slices 14 --ground-truth-voxel 1 --json phantom.json",
          "info l3/ct --json ct.json", "info bone.vdb --json bone.json",
          "plan bone.vdb --entry 4,-8,34 --target 12.5,0.5,26 -o mine.json",
          "render bone.vdb --plan plan.json --cut path -o cut.png", "mesh bone.vdb -o bone.obj --json mesh.json",
          "plan bone.vdb --entry 4,x,34 --target 12.5,0.5,26 -o none.json"}) {
      const test::ProgramRun run = test::run_program(arguments, folder.path(), before);
      said[arguments] = std::to_string(run.exit_code) + run.output + run.errors;
    }
    Files files = files_in(folder.path());
    files.merge(said);
    return files;
  };
  expect_same(work_under("de_DE.UTF-8"), work_under("C"));
}

}  // namespace
}  // namespace spinaltap
