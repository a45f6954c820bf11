// Drilling from the command line: engines, tools, densities of points, and the files that come of it.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "apps/common/json_file.h"
#include "apps/common/plan_file.h"
#include "core/base/random.h"
#include "core/rbf/fit_rbf.h"
#include "core/rbf/rbf_file.h"
#include "tests/cli/program.h"
#include "tests/support/made_bone.h"
#include "tests/support/temporary_folder.h"
#include "vdb/points_file.h"

namespace spinaltap {
namespace {

const Vec3 kCentre(10.0, -4.0, 30.0);
constexpr double kRadiusMm = 6.0;

class Drill : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    const Vec3 corner = Vec3::Constant(kRadiusMm + 2.0);
    write_bone(test::made_bone([](const Vec3& p) { return (p - kCentre).norm() - kRadiusMm; },
                               {kCentre - corner, kCentre + corner}, 0.25),
               folder_->path() / "bone.vdb");
    write_plan({path({2.0, 20.0, 2.0})}, folder_->path() / "plan.json");
  }
  static void TearDownTestSuite() { delete folder_; }

  /// Through the ball's middle, 2 mm short of its far side.
  static DrillPath path(const DrillBit& bit) {
    const Vec3 direction = Vec3(1.0, 2.0, -2.0) / 3.0;
    return {"middle", kCentre - kRadiusMm * direction, kCentre + (kRadiusMm - 2.0) * direction, bit};
  }

  static Json drill(const std::string& options, const std::string& plan = "plan.json") {
    const test::ProgramRun run = test::run_program(
        "drill bone.vdb " + plan + " --radius 2 --spacing 0.2 --step 0.01 -o out --json out.json " + options,
        folder_->path());
    EXPECT_EQ(run.exit_code, 0) << options << "\n" << run.errors;
    return read_json(folder_->path() / "out.json");
  }

  static const test::TemporaryFolder* folder_;
};

const test::TemporaryFolder* Drill::folder_ = nullptr;

TEST_F(Drill, WritesThePointsThatAreLeft) {
  const Json figures = drill("--points --engine leaf --hu-bits 8");
  const SavedPoints points = read_points(folder_->path() / "out" / "points.vdb");
  ASSERT_EQ(points.positions_mm.size(),
            figures["points_in_bone"].get<std::size_t>() - figures["removed"].get<std::size_t>());
  const DrillPath drilled = path({});
  for (const Vec3& p : points.positions_mm) {
    ASSERT_LT((p - kCentre).norm(), kRadiusMm + 0.05);  // the grid's voxels
    const Vec3 from_entry = p - drilled.entry_mm;
    const double along_mm = from_entry.dot(drilled.direction());
    const bool is_beside_cylinder = along_mm < drilled.length_mm() - 2.0;
    if (is_beside_cylinder) {
      ASSERT_GT((from_entry - along_mm * drilled.direction()).norm(), 1.0);
    }
  }
}

TEST_F(Drill, TakesFinerPointsNearTheSurfaceThatAFittedFunctionHas) {
  // A ball 0.5 mm smaller than the baked one.
  RbfValues values;
  for (std::uint64_t n = 0; n < 300; ++n) {
    const double z = 2.0 * random_uniform(1, n) - 1.0;
    const double angle = 2.0 * std::numbers::pi * random_uniform(2, n);
    const Vec3 out(std::sqrt(1.0 - z * z) * std::cos(angle), std::sqrt(1.0 - z * z) * std::sin(angle), z);
    for (const double off_mm : {-1.0, 0.0, 1.0}) {
      values.points_mm.emplace_back(kCentre + (kRadiusMm - 0.5 + off_mm) * out);
      values.values_mm.push_back(off_mm);
    }
  }
  write_rbf(fit_rbf(values).model, folder_->path() / "ball.rbf");
  drill("--fine-spacing 0.1 --fine-near 1 --points --rbf ball.rbf");
  double furthest_mm = 0.0;
  for (const char* name : {"points_1.vdb", "points_2.vdb"}) {
    for (const Vec3& p : read_points(folder_->path() / "out" / name).positions_mm) {
      furthest_mm = std::max(furthest_mm, (p - kCentre).norm());
    }
  }
  // Between 300 places 1 mm apart a fitted ball strays by less than a tenth.
  EXPECT_NEAR(furthest_mm, kRadiusMm - 0.5, 0.1);
}

TEST_F(Drill, TakesBitsOfOtherShapes) {
  DrillBit burr{3.0, 20.0, 1.0, BitShape::round_burr};
  burr.shank_diameter_mm = 1.0;
  write_plan({path(burr)}, folder_->path() / "burr.json");
  const Json figures = drill("", "burr.json");
  EXPECT_GT(figures["removed"].get<int>(), 6000);
  EXPECT_EQ(figures["mesh"]["closed"], true);
}

TEST_F(Drill, RefusesOptionsWithoutSense) {
  for (const char* options : {"--jitter 0.7", "--engine fast", "--hu-bits 12", "--fine-spacing -1", "--rbf none.rbf",
                              "--subdivision squares"}) {
    const test::ProgramRun run =
        test::run_program(std::string("drill bone.vdb plan.json -o refused ") + options, folder_->path());
    EXPECT_NE(run.exit_code, 0) << options;
    EXPECT_FALSE(run.errors.empty()) << options;
    EXPECT_FALSE(std::filesystem::exists(folder_->path() / "refused")) << options;
  }
}

}  // namespace
}  // namespace spinaltap
