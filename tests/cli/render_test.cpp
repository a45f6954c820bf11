// Pictures from the command line: render, its frames, and what drill writes to draw.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "core/base/staged_output.h"
#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "mesh/mesh_io.h"
#include "mesh/mesh_quality.h"
#include "tests/cli/bone_ball.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;

/// Width and height, pixels; 0 where it is no PNG.
std::array<int, 2> png_size(const std::filesystem::path& file) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&header, file.c_str()) == 0) return {0, 0};
  const std::array<int, 2> size{static_cast<int>(header.width), static_cast<int>(header.height)};
  png_image_free(&header);
  return size;
}

class Render : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    test::write_bone_ball(folder_->path() / "bone.vdb");
    const Vec3 direction = Vec3(1.0, -2.0, -2.0) / 3.0;
    write_plan({{"in", test::kBoneCentre - test::kBoneRadiusMm * direction, test::kBoneCentre + 3.0 * direction,
                 DrillBit{2.0, 30.0, 2.0}}},
               folder_->path() / "plan.json");
    const test::ProgramRun drilled =
        run("drill bone.vdb plan.json --radius 1.6 --operator tremor --record run.h5 --splats --no-pictures -o out");
    EXPECT_EQ(drilled.exit_code, 0) << drilled.errors;
  }
  static void TearDownTestSuite() { delete folder_; }
  static test::ProgramRun run(const std::string& arguments) {
    return test::run_program(arguments + " --force", folder_->path());
  }
  static std::filesystem::path file(const std::string& name) { return folder_->path() / name; }

  static const test::TemporaryFolder* folder_;
};

const test::TemporaryFolder* Render::folder_ = nullptr;

TEST_F(Render, DrawsABoneItsPlanAndItsHole) {
  std::set<std::string> pictures;
  int count = 0;
  for (const char* arguments :
       {"bone.vdb", "bone.vdb --plan plan.json", "bone.vdb --plan plan.json --opacity 0.3", "out/drilled.vdb",
        "out/drilled.vdb --plan plan.json --view hole", "out/drilled.vdb --plan plan.json --cut path",
        "out/drilled.vdb --plan plan.json --cut upright", "out/drilled.vdb --plan plan.json --path in --close-up 6",
        "bone.vdb --record run.h5", "bone.vdb --record run.h5 --at 4", "bone.vdb --cut axial"}) {
    SCOPED_TRACE(arguments);
    const test::ProgramRun drawn = run("render " + std::string(arguments) + " --size 160x120 -o picture.png");
    ASSERT_EQ(drawn.exit_code, 0) << drawn.errors;
    EXPECT_THAT(drawn.output, HasSubstr("picture.png"));
    EXPECT_EQ(png_size(file("picture.png")), (std::array{160, 120}));
    pictures.insert(read_whole_file(file("picture.png")));
    ++count;
  }
  EXPECT_EQ(pictures.size(), static_cast<std::size_t>(count)) << "each shows something else";
}

TEST_F(Render, DrawsDepthNormalsAndMaskSideBySide) {
  std::set<std::string> pictures;
  for (const char* arguments : {"bone.vdb", "out/drilled.vdb --plan plan.json --view hole", "bone.vdb --record run.h5",
                                "bone.vdb --record run.h5 --close-up 6"}) {
    SCOPED_TRACE(arguments);
    const test::ProgramRun drawn = run("render " + std::string(arguments) + " --depth --size 80x60 -o depth.png");
    ASSERT_EQ(drawn.exit_code, 0) << drawn.errors;
    EXPECT_EQ(png_size(file("depth.png")), (std::array{240, 60}));
    pictures.insert(read_whole_file(file("depth.png")));
  }
  EXPECT_EQ(pictures.size(), 4U);
}

TEST_F(Render, DrawsTheSameAtOneThreadAndTwo) {
  const auto picture = [&](const char* threads) {
    const test::ProgramRun drawn =
        run("render out/drilled.vdb --plan plan.json --opacity 0.5 --size 160x120 --threads " + std::string(threads) +
            " -o threads.png");
    EXPECT_EQ(drawn.exit_code, 0) << drawn.errors;
    return read_whole_file(file("threads.png"));
  };
  EXPECT_EQ(picture("1"), picture("2"));
}

TEST_F(Render, DrawsAFilmOfARecord) {
  const test::ProgramRun film = run(
      "render bone.vdb --record run.h5 --cut upright --frames film --fps 2 --speed 2 --size 80x60 --json film.json");
  ASSERT_EQ(film.exit_code, 0) << film.errors;
  const Json figures = read_json(file("film.json"));
  // 3 mm before the entry and 9 mm of path at 1 mm/s, a frame each second of it, and one at the begin.
  EXPECT_NEAR(figures["seconds"].get<double>(), 12.0, 0.1);
  const auto frames = figures["frames"].get<std::size_t>();
  EXPECT_NEAR(static_cast<double>(frames), 13.0, 1.0);
  std::vector<std::string> names = test::everything_in(file("film"));
  ASSERT_EQ(std::erase(names, "files.txt"), 1U);
  ASSERT_EQ(names.size(), frames);
  EXPECT_EQ(names.front(), "00001.png");
  std::set<std::string> different;
  for (const std::string& name : names) {
    EXPECT_EQ(png_size(file("film") / name), (std::array{80, 60}));
    different.insert(read_whole_file(file("film") / name));
  }
  EXPECT_EQ(different.size(), frames) << "the bit moves in each";
}

TEST_F(Render, WritesWhatAnotherRendererDraws) {
  const TriangleMesh around = read_mesh(file("out/around.ply"));
  const MeshQuality quality = measure_mesh(around);
  EXPECT_EQ(quality.rejected_faces, 0U);
  EXPECT_GT(quality.boundary_edges, 20U) << "open where the points are";
  EXPECT_NEAR(quality.area_mm2, 4.0 * std::numbers::pi * test::kBoneRadiusMm * test::kBoneRadiusMm, 12.0);
  const std::string splats = read_whole_file(file("out/splats.ply"));
  EXPECT_EQ(splats.substr(0, 4), "ply\n");
  // A ring around the hole on the surface, and the hole's wall: 9 mm of it, 0.1 mm apart.
  const std::size_t at = splats.find("element vertex ");
  EXPECT_GT(std::stoul(splats.substr(at + 15)), 4000U);
}

TEST_F(Render, MeshesADrilledBoneWithItsRim) {
  const test::ProgramRun meshed = run("mesh out/drilled.vdb -o drilled.stl --json mesh.json");
  ASSERT_EQ(meshed.exit_code, 0) << meshed.errors;
  const Json figures = read_json(file("mesh.json"));
  EXPECT_TRUE(figures["reached"].get<bool>());
  EXPECT_TRUE(figures["closed"].get<bool>());
  EXPECT_LE(figures["mesh_to_surface"]["max_mm"].get<double>(), 0.05);
  EXPECT_LE(figures["surface_to_mesh"]["max_mm"].get<double>(), 0.05);
  EXPECT_LT(figures["triangles"].get<std::size_t>(), 3000U);
}

TEST_F(Render, RejectsInOneLineAndLeavesNoPicture) {
  for (const char* arguments :
       {"bone.vdb --view hole", "bone.vdb --cut path", "bone.vdb --close-up 5", "bone.vdb --view nowhere",
        "bone.vdb --cut nowhere", "bone.vdb --size 100", "bone.vdb --size 0x10", "bone.vdb --size 100000x10",
        "bone.vdb --opacity 2", "bone.vdb --depth --cut axial", "bone.vdb --at 3", "bone.vdb --frames f",
        "bone.vdb --plan none.json", "bone.vdb --plan plan.json --path other", "bone.vdb --record plan.json",
        "out/drilled.vdb --record run.h5", "none.vdb", "bone.vdb --record run.h5 --frames f --fps 0",
        "bone.vdb --record run.h5 --frames f --speed 1e-9"}) {
    SCOPED_TRACE(arguments);
    const test::ProgramRun rejected = run("render " + std::string(arguments) + " -o rejected.png");
    EXPECT_NE(rejected.exit_code, 0);
    EXPECT_EQ(std::count(rejected.errors.begin(), rejected.errors.end(), '\n'), 1) << rejected.errors;
    EXPECT_FALSE(std::filesystem::exists(file("rejected.png")));
    EXPECT_FALSE(std::filesystem::exists(file("f")));
  }
}

}  // namespace
}  // namespace spinaltap
