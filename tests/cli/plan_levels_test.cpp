#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "core/phantom/vertebra.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/spine_file.h"

namespace spinaltap {
namespace {

using ::testing::HasSubstr;

TEST(PlanLevels, WritesAPlanAndAReportOfEachLevelAndTheRods) {
  const test::TemporaryFolder folder;
  constexpr double kApartMm = 34.0;
  std::vector<SpineBone> bones;
  for (const char* name : {"L2", "L3", "L4"}) {
    VertebraAnatomy anatomy;
    anatomy.placement = {Vec3(0.0, 0.0, -kApartMm * static_cast<double>(bones.size())), Vec3::Zero()};
    SpineBone bone{level_from_name(name).value(), bake_solid(Vertebra(anatomy), {.voxel_mm = 0.5}, 40.0), {}};
    bones.push_back(std::move(bone));
  }
  write_spine(bones, folder.path() / "spine.vdb");
  const test::ProgramRun planned =
      test::run_program("plan spine.vdb --auto --levels all -o plans --errors none --json out.json", folder.path());
  ASSERT_EQ(planned.exit_code, 0) << planned.errors;
  EXPECT_THAT(planned.output, HasSubstr("left rod"));
  for (const char* name : {"L2", "L3", "L4"}) {
    EXPECT_EQ(read_plan(folder.path() / "plans" / (std::string(name) + ".json")).size(), 2U);
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "plans" / (std::string(name) + ".html")));
  }
  const Json rods = read_json(folder.path() / "plans" / "rods.json")["rods"];
  ASSERT_EQ(rods.size(), 2U);
  for (const Json& rod : rods) {
    // Three equal vertebrae, one below the other: their heads lie in a line, as far apart as they do.
    ASSERT_EQ(rod["heads"].size(), 3U);
    EXPECT_LT(rod["max_offset_mm"].get<double>(), 1.0);
    for (std::size_t n = 0; n < 2; ++n) {
      EXPECT_NEAR(rod["heads"][n]["to_next_mm"].get<double>(), kApartMm, 3.0);
      EXPECT_LT(rod["heads"][n]["to_next_deg"].get<double>(), 8.0);
    }
  }
  EXPECT_EQ(read_json(folder.path() / "out.json")["levels"].size(), 3U);
  const test::ProgramRun missing = test::run_program("plan spine.vdb --auto --levels L2,T4 -o other", folder.path());
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.errors, HasSubstr("no T4"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "other"));
}

}  // namespace
}  // namespace spinaltap
