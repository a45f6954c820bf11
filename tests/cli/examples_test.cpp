// The example programs, which are what programs of others look like.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "core/files/plan_file.h"
#include "mesh/mesh_io.h"
#include "mesh/mesh_quality.h"
#include "tests/cli/program.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"
#include "vdb/sim/bone.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;

constexpr double kStepMm = 0.02;  ///< of the robot's poses

/// A phantom, its baked bone and a plan.
class Examples : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    for (const char* command : {"phantom l3 --pixel 0.6 --size 300 --slices 50 --slice-step 1 --ground-truth-voxel 1",
                                "bake l3/ct -o bone.vdb --voxel 0.6", "plan bone.vdb --auto -o plan.json"}) {
      const test::ProgramRun run = test::run_program(command, folder_->path());
      ASSERT_EQ(run.exit_code, 0) << command << ": " << run.errors;
    }
  }
  static void TearDownTestSuite() { delete folder_; }

  static test::ProgramRun example(const std::string& name, const std::string& arguments) {
    return test::run_command(std::string("'") + test::kProgramFolder + "/example_" + name + "' " + arguments,
                             folder_->path());
  }

  static inline test::TemporaryFolder* folder_ = nullptr;
};

TEST_F(Examples, BakeAndDrillGivesForcesAtEachStepInFifteenLines) {
  const test::ProgramRun run = example("bake_and_drill", "l3/ct");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  std::istringstream lines(run.output);
  std::size_t cycles = 0;
  double max_n = 0.0;
  for (std::string line; std::getline(lines, line); ++cycles) {
    double depth_mm = 0.0, thrust_n = 0.0, torque_n_mm = 0.0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf mm: %lf N, %lf N mm", &depth_mm, &thrust_n, &torque_n_mm), 3) << line;
    max_n = std::max(max_n, thrust_n);
  }
  EXPECT_GT(cycles, 20'000U);
  EXPECT_GT(max_n, 3.0) << "the cortex resists";
  EXPECT_LT(max_n, 300.0);

  std::ifstream source(std::string(test::kSourceFolder) + "/apps/examples/bake_and_drill.cpp");
  std::size_t lines_of_code = 0;
  for (std::string line; std::getline(source, line);) {
    if (!line.empty() && !line.starts_with("//")) ++lines_of_code;
  }
  EXPECT_GT(lines_of_code, 5U);
  EXPECT_LE(lines_of_code, 15U);
}

TEST_F(Examples, ToolChangeInCMillsWithoutAPathAndStandsInTheGuide) {
  const test::ProgramRun run = example("tool_change_c", "bone.vdb");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("voxels of 0.2 mm of the whole bone, for no path"));
  double time_s = 0.0, most_n = 0.0;
  unsigned blocks = 0, events = 0;
  const std::string figures = run.output.substr(run.output.find('\n') + 1);
  ASSERT_EQ(std::sscanf(figures.c_str(), "%lf s, %lf N at most, %u blocks of surface drawn, %u", &time_s, &most_n,
                        &blocks, &events),
            4);
  EXPECT_NEAR(time_s, 5.0, 0.01);
  EXPECT_GT(most_n, 1.0);
  EXPECT_GE(events, 2U) << "contact and a change of tools";
  EXPECT_EQ(example("tool_change", "bone.vdb").output, run.output) << "in C++";
  const auto text_of = [](const char* file) {
    std::ifstream stream(std::string(test::kSourceFolder) + file);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  };
  EXPECT_THAT(text_of("/docs/c-interface.md"), HasSubstr("```c\n" + text_of("/apps/examples/tool_change.c") + "```"));
  EXPECT_EQ(example("tool_change_c", "none.vdb").exit_code, 2);
}

TEST_F(Examples, HapticLoopDrillsAgainstTheClock) {
  const test::ProgramRun run = example("haptic_loop", "bone.vdb plan.json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  double depth_mm = 0.0, time_s = 0.0, most_n = 0.0;
  ASSERT_EQ(std::sscanf(run.output.c_str(), "%lf mm deep after %lf s, %lf N", &depth_mm, &time_s, &most_n), 3);
  EXPECT_GT(depth_mm, 0.3) << "into the cortex";
  EXPECT_GT(time_s, 1.0);
  EXPECT_GT(most_n, 3.0);
  std::size_t blocks = 0;
  const std::size_t at = run.output.find("the bone is whole again");
  ASSERT_NE(at, std::string::npos) << run.output;
  ASSERT_EQ(std::sscanf(run.output.c_str() + at, "the bone is whole again: %zu blocks", &blocks), 1);
  EXPECT_GT(blocks, 0U);
}

TEST_F(Examples, RobotStopsBeforeTheWall) {
  const Bone bone = Bone::load(folder_->path() / "bone.vdb");
  const DrillPath path = read_plan(folder_->path() / "plan.json").front();
  // Along the plan, and on a line that leaves it to the side by 15 degrees: out of the pedicle.
  const Vec3 aside = path.direction().cross(Vec3::UnitZ()).normalized();
  const double angle = 15.0 * std::numbers::pi / 180.0;
  const auto write_poses = [&](const char* name, const Vec3& axis) {
    std::ofstream file(folder_->path() / name);
    file.precision(17);
    file << "time_s,x_mm,y_mm,z_mm,axis_x,axis_y,axis_z\n";
    const std::size_t count = static_cast<std::size_t>((path.length_mm() + 3.0) / kStepMm);
    for (std::size_t n = 0; n <= count; ++n) {
      const Vec3 tip = path.entry_mm + (kStepMm * static_cast<double>(n) - 3.0) * axis;
      file << 0.01 * static_cast<double>(n);
      for (const Vec3& v : {tip, axis}) file << ',' << v.x() << ',' << v.y() << ',' << v.z();
      file << '\n';
    }
    return count + 1;
  };
  const std::size_t planned = write_poses("planned.csv", path.direction());
  write_poses("tilted.csv", std::cos(angle) * path.direction() + std::sin(angle) * aside);

  const test::ProgramRun along = example("robot", "bone.vdb plan.json planned.csv planned.h5");
  ASSERT_EQ(along.exit_code, 0) << along.errors;
  EXPECT_THAT(along.output, HasSubstr("done after " + std::to_string(planned) + " poses"));
  EXPECT_THAT(along.output, HasSubstr("contact"));
  EXPECT_THAT(along.output, HasSubstr(std::to_string(planned) + " cycles again: the same"));

  const test::ProgramRun tilted = example("robot", "bone.vdb plan.json tilted.csv tilted.h5");
  ASSERT_EQ(tilted.exit_code, 0) << tilted.errors;
  std::size_t poses = 0;
  double depth_mm = 0.0, thrust_n = 0.0, outer_mm = 0.0, canal_mm = 0.0;
  ASSERT_EQ(std::sscanf(tilted.output.c_str(),
                        "stopped after %zu poses, %lf mm deep, %lf N at most; %lf mm from the outer surface, %lf mm",
                        &poses, &depth_mm, &thrust_n, &outer_mm, &canal_mm),
            5)
      << tilted.output;
  EXPECT_LT(poses, planned);
  // A step brings it nearer by no more than its own length.
  EXPECT_LE(std::min(outer_mm, canal_mm), 0.5);
  EXPECT_GT(std::min(outer_mm, canal_mm), 0.5 - kStepMm - 0.001);
  EXPECT_THAT(tilted.output, HasSubstr("stop: clearance"));
  const test::ProgramRun replayed = test::run_program("replay tilted.h5 bone.vdb", folder_->path());
  EXPECT_EQ(replayed.exit_code, 0) << replayed.errors;
}

/// What openvdb_grids prints.
struct SeenGrids {
  double volume_mm3 = 0.0, area_mm2 = 0.0, median_hu = 0.0, low_hu = 0.0, high_hu = 0.0;
};
SeenGrids seen_grids(const std::string& output) {
  SeenGrids seen;
  std::size_t points = 0, faces = 0;
  EXPECT_EQ(
      std::sscanf(output.c_str(),
                  "%zu points, %zu faces volume %lf mm3, area %lf mm2 2 mm below the surface: median %lf HU, "
                  "from %lf to %lf",
                  &points, &faces, &seen.volume_mm3, &seen.area_mm2, &seen.median_hu, &seen.low_hu, &seen.high_hu),
      7)
      << output;
  return seen;
}

TEST_F(Examples, OpenVdbAloneMeasuresABakedBall) {
  const double radius_mm = 6.0;
  write_bone(test::bake_ball({Vec3(3.0, -2.0, 10.0), radius_mm}), folder_->path() / "ball.vdb");
  const test::ProgramRun run = example("openvdb_grids", "ball.vdb ball.obj");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const SeenGrids seen = seen_grids(run.output);
  const double volume_mm3 = 4.0 / 3.0 * std::numbers::pi * std::pow(radius_mm, 3);
  const double area_mm2 = 4.0 * std::numbers::pi * std::pow(radius_mm, 2);
  // OpenVDB sums over voxels with a smeared delta; the bake's own ball is right to 0.01 mm.
  EXPECT_NEAR(seen.volume_mm3, volume_mm3, 0.01 * volume_mm3);
  EXPECT_NEAR(seen.area_mm2, area_mm2, 0.01 * area_mm2);
  EXPECT_EQ(seen.median_hu, 300.0) << "the ball's CT number";
  EXPECT_EQ(seen.low_hu, 300.0);

  const MeshQuality mesh = measure_mesh(read_mesh(folder_->path() / "ball.obj"));
  EXPECT_TRUE(mesh.closed());
  // A chord of a voxel of 0.25 mm lies h^2 / 8 R below the ball: 0.1 % of the volume.
  EXPECT_NEAR(mesh.volume_mm3, volume_mm3, 0.005 * volume_mm3) << "positive: faces wind outward";
}

TEST_F(Examples, OpenVdbAloneFindsWhatABoneSays) {
  const test::ProgramRun run = example("openvdb_grids", "bone.vdb bone.obj");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const SeenGrids seen = seen_grids(run.output);
  const Bone bone = Bone::load(folder_->path() / "bone.vdb");
  const TriangleMesh surface = read_mesh(folder_->path() / "bone.obj");
  std::vector<Vec3> points_mm;
  for (const auto& vertex_mm : surface.vertices_mm) points_mm.emplace_back(vertex_mm.cast<double>());
  const std::vector<float> distances_mm = bone.distance(points_mm);
  const auto far = std::ranges::count_if(distances_mm, [&](float mm) { return std::abs(mm) > 0.2 * 0.6; });
  EXPECT_LT(static_cast<double>(far), 0.01 * static_cast<double>(points_mm.size())) << "of a voxel of 0.6 mm";

  const std::vector<Vec3> normals = bone.normals(points_mm);
  for (std::size_t n = 0; n < points_mm.size(); ++n) points_mm[n] -= 2.0 * normals[n];
  std::vector<float> below_hu = bone.hu(points_mm);
  std::ranges::nth_element(below_hu, below_hu.begin() + static_cast<std::ptrdiff_t>(below_hu.size() / 2));
  // Normals by another stencil.
  EXPECT_NEAR(seen.median_hu, below_hu[below_hu.size() / 2], 5.0);
}

TEST_F(Examples, StandInTheirGuides) {
  const auto text_of = [](const std::string& file) {
    std::ostringstream text;
    text << std::ifstream(std::string(test::kSourceFolder) + "/apps/examples/" + file).rdbuf();
    return text.str();
  };
  const std::map<std::string, std::string> guides{
      {"haptic_loop.cpp", "simulators.md"}, {"robot.cpp", "robots.md"},
      {"openvdb_grids.cpp", "bone-vdb.md"}, {"tool_change.cpp", "tool-change.md"},
      {"study.cpp", "study-program.md"},    {"surface_blocks.cpp", "surface-blocks.md"}};
  for (const auto& [source, guide] : guides) {
    EXPECT_THAT(text_of("../../docs/" + guide), HasSubstr("```cpp\n" + text_of(source) + "```")) << guide;
  }
}

TEST_F(Examples, SurfaceBlocksKeepWhatARendererDraws) {
  const test::ProgramRun run = example("surface_blocks", "bone.vdb plan.json drilled.ply");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  std::size_t whole = 0, changed = 0, triangles = 0, walls = 0;
  ASSERT_EQ(
      std::sscanf(run.output.c_str(), "%zu blocks at first, %zu changed; %zu triangles, %zu of them drilled walls",
                  &whole, &changed, &triangles, &walls),
      4)
      << run.output;
  EXPECT_GT(changed, 10U);
  EXPECT_GT(walls, 1000U) << "a hole of 3 mm";
  const TriangleMesh mesh = read_mesh(folder_->path() / "drilled.ply");
  EXPECT_EQ(mesh.triangles.size(), triangles);
}

TEST_F(Examples, StudyCountsBreaches) {
  const test::ProgramRun run = example("study", "bone.vdb plan.json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr(" of 40 runs breach"));
}

TEST_F(Examples, SayWhatIsWrong) {
  const test::ProgramRun run = example("study", "none.vdb plan.json");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("none.vdb"));
}

}  // namespace
}  // namespace spinaltap
