// Drilling from the command line: engines, tools, densities of points, and the files that come of it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>

#include "core/base/random.h"
#include "core/base/staged_output.h"
#include "core/base/text_writer.h"
#include "core/ct/label_volume.h"
#include "core/files/bit_file.h"
#include "core/files/json_file.h"
#include "core/files/milling_file.h"
#include "core/files/plan_file.h"
#include "core/rbf/fit_rbf.h"
#include "core/rbf/rbf_file.h"
#include "tests/cli/bone_ball.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"
#include "vdb/engine/points_file.h"

namespace spinaltap {
namespace {

using test::kBoneCentre;
using test::kBoneRadiusMm;
using testing::HasSubstr;
using testing::Not;

class Drill : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    test::write_bone_ball(folder_->path() / "bone.vdb");
    write_plan({path({2.0, 20.0, 2.0})}, folder_->path() / "plan.json");
  }
  static void TearDownTestSuite() { delete folder_; }

  /// Through the ball's middle, 2 mm short of its far side.
  static DrillPath path(const DrillBit& bit) {
    const Vec3 direction = Vec3(1.0, 2.0, -2.0) / 3.0;
    return {"middle", kBoneCentre - kBoneRadiusMm * direction, kBoneCentre + (kBoneRadiusMm - 2.0) * direction, bit};
  }

  static Json drill(const std::string& options, const std::string& plan = "plan.json", int exit_code = 0) {
    const test::ProgramRun run =
        test::run_program("drill bone.vdb " + plan +
                              " --radius 2 --spacing 0.2 --step 0.01 -o out --force --json out.json --full-mesh "
                              "--no-pictures " +
                              options,
                          folder_->path());
    EXPECT_EQ(run.exit_code, exit_code) << options << "\n" << run.errors;
    return read_json(folder_->path() / "out.json");
  }

  static const test::TemporaryFolder* folder_;
};

const test::TemporaryFolder* Drill::folder_ = nullptr;

TEST_F(Drill, GoesThroughSeveralBonesAndWritesEach) {
  const std::filesystem::path& folder = folder_->path();
  const DrillPath first = path({2.0, 40.0, 2.0});
  const Vec3 direction = first.direction();
  // A second ball of 4 mm, 2 mm behind the first.
  const Vec3 centre_mm = kBoneCentre + 12.0 * direction;
  const Vec3 corner = Vec3::Constant(6.0);
  write_bone(test::made_bone([=](const Vec3& p) { return (p - centre_mm).norm() - 4.0; },
                             {centre_mm - corner, centre_mm + corner}, 0.25),
             folder / "second.vdb");
  DrillPath through = first;
  through.target_mm = centre_mm + 3.0 * direction;
  write_plan({through}, folder / "through.json");
  const Json one = drill("--engine voxel --no-clearances", "through.json");
  const Json both = drill("--additional-bone second.vdb --no-clearances --voxels --record both.h5", "through.json");
  EXPECT_EQ(both["engine"], "voxel");
  EXPECT_EQ(both["also_drilled"], Json::array({"drilled_2.vdb"}));
  const auto mm3 = [](const Json& figures, const char* key) { return 8e-3 * figures[key].get<double>(); };
  const double second_mm3 = 4.0 / 3.0 * std::numbers::pi * 64.0;
  EXPECT_NEAR(mm3(both, "voxels_in_bone") - mm3(one, "voxels_in_bone"), second_mm3, 0.01 * second_mm3);
  // 7 mm deep: a cylinder of 1 mm, less the ball's rounding and two thirds of a cone of 2 mm.
  const double cap_mm = 4.0 - std::sqrt(15.0);
  const double hole_mm3 = std::numbers::pi * (7.0 - 4.0 / 3.0 - cap_mm / 2.0);
  EXPECT_NEAR(mm3(both, "removed") - mm3(one, "removed"), hole_mm3, 0.06 * hole_mm3);
  for (const char* name : {"drilled.vdb", "drilled.stl", "drilled_2.vdb", "drilled_2.stl"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / "out" / name)) << name;
  }
  const BoneModel drilled = read_bone(folder / "out" / "drilled_2.vdb");
  const std::array<Vec3, 2> places{centre_mm, centre_mm + 2.0 * any_perpendicular(direction)};
  std::array<std::uint8_t, 2> inside{};
  drilled.inside(places, inside);
  EXPECT_EQ(inside, (std::array<std::uint8_t, 2>{0, 1}));
  // A map in a box of its own, by the place of each voxel of 0.2 mm.
  GridGeometry around;
  around.size = {120, 120, 120};
  around.spacing_mm = Vec3::Constant(0.2);
  around.origin_mm = centre_mm - Vec3::Constant(12.0);
  const LabelVolume map =
      read_label_volume(folder / "out" / "voxels.nii.gz", around, {.convention = LabelConvention::any_names});
  EXPECT_EQ(map.names.at(1).name, "occupied bone");
  EXPECT_EQ(map.labels[around.offset(60, 60, 60)], 0) << "in the hole";
  const Vec3 beside = around.to_index(places[1]).array().round();
  EXPECT_EQ(map.labels[around.offset(static_cast<int>(beside.x()), static_cast<int>(beside.y()),
                                     static_cast<int>(beside.z()))],
            1);

  EXPECT_EQ(test::run_program("replay both.h5 bone.vdb --additional-bone second.vdb", folder).exit_code, 0);
  EXPECT_EQ(test::run_program("render bone.vdb --record both.h5 -o first.png", folder).exit_code, 0);
  EXPECT_EQ(test::run_program("render second.vdb --record both.h5 -o second.png", folder).exit_code, 0);
  const test::ProgramRun alone = test::run_program("replay both.h5 bone.vdb", folder);
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_THAT(alone.errors, HasSubstr("expected the 2 bones"));
  const auto says = [&](const std::string& options, const char* words) {
    const test::ProgramRun run = test::run_program("drill bone.vdb through.json -o no " + options, folder);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.errors, HasSubstr(words));
  };
  says("--additional-bone second.vdb --engine ring", "only voxels can fill several bones");
  says("--additional-bone second.vdb --points", "expected an engine of points");
  says("--voxels", "expected voxels with --voxels");
  says("--additional-bone bone.vdb", "found one twice");
  says("--additional-bone second.vdb:nonsense", "FILE or FILE:LEVEL");
  says("--additional-bone nothing.vdb", "nothing.vdb");
}

TEST_F(Drill, WritesThePointsThatAreLeft) {
  const Json figures = drill("--points --engine leaf --hu-bits 8");
  const SavedPoints points = read_points(folder_->path() / "out" / "points.vdb");
  ASSERT_EQ(points.positions_mm.size(),
            figures["points_in_bone"].get<std::size_t>() - figures["removed"].get<std::size_t>());
  const DrillPath drilled = path({});
  for (const Vec3& p : points.positions_mm) {
    ASSERT_LT((p - kBoneCentre).norm(), kBoneRadiusMm + 0.05);  // the grid's voxels
    const Vec3 from_entry = p - drilled.entry_mm;
    const double along_mm = from_entry.dot(drilled.direction());
    const bool is_beside_cylinder = along_mm < drilled.length_mm() - 2.0;
    if (is_beside_cylinder) {
      ASSERT_GT((from_entry - along_mm * drilled.direction()).norm(), 1.0);
    }
  }
}

TEST_F(Drill, TakesAToolOfAnyOutlineFromPlanToReplay) {
  const DrillPath planned = path({});
  const auto option = [](const char* name, const Vec3& p) {
    return joined(" ", name, " ", p.x(), ",", p.y(), ",", p.z());
  };
  const std::string plan = "plan bone.vdb --force -o headed.json" + option("--entry", planned.entry_mm) +
                           option("--target", planned.target_mm);
  ASSERT_EQ(test::run_program(plan + " --bit match-head", folder_->path()).exit_code, 0);
  EXPECT_EQ(read_plan(folder_->path() / "headed.json")[0].bit, read_bit_profile("match-head").bit);
  drill("--points --record run.h5", "headed.json");
  const SavedPoints points = read_points(folder_->path() / "out" / "points.vdb");
  ASSERT_FALSE(points.positions_mm.empty());
  // Its round end is as deep as it is wide; where that has passed, the neck leaves nothing.
  for (const Vec3& p : points.positions_mm) {
    const Vec3 from_entry = p - planned.entry_mm;
    const double along_mm = from_entry.dot(planned.direction());
    if (along_mm < planned.length_mm() - 1.5) {
      ASSERT_GT((from_entry - along_mm * planned.direction()).norm(), 1.5);
    }
  }
  EXPECT_EQ(test::run_program("replay run.h5 bone.vdb", folder_->path()).exit_code, 0);
  for (const auto& [options, what] :
       {std::pair(" --bit spoon", "match-head, probe, reamer, tap"), std::pair(" --bit plan.json", "plan.json"),
        std::pair(" --bit match-head --diameter 3", "--bit excludes --diameter")}) {
    const test::ProgramRun run = test::run_program(plan + options, folder_->path());
    EXPECT_EQ(run.exit_code, 2) << options;
    EXPECT_THAT(run.errors, HasSubstr(what));
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
      values.points_mm.emplace_back(kBoneCentre + (kBoneRadiusMm - 0.5 + off_mm) * out);
      values.values_mm.push_back(off_mm);
    }
  }
  write_rbf(fit_rbf(values).model, folder_->path() / "ball.rbf");
  drill("--fine-spacing 0.1 --fine-near 1 --points --rbf ball.rbf");
  double furthest_mm = 0.0;
  for (const char* name : {"points_1.vdb", "points_2.vdb"}) {
    for (const Vec3& p : read_points(folder_->path() / "out" / name).positions_mm) {
      furthest_mm = std::max(furthest_mm, (p - kBoneCentre).norm());
    }
  }
  // Between 300 places 1 mm apart a fitted ball strays by less than a tenth.
  EXPECT_NEAR(furthest_mm, kBoneRadiusMm - 0.5, 0.1);
}

TEST_F(Drill, TakesBitsOfOtherShapes) {
  DrillBit burr{3.0, 20.0, 1.0, BitShape::round_burr};
  burr.shank_diameter_mm = 1.0;
  write_plan({path(burr)}, folder_->path() / "burr.json");
  const Json figures = drill("", "burr.json");
  EXPECT_GT(figures["removed"].get<int>(), 6000);
  EXPECT_EQ(figures["mesh"]["closed"], true);
}

TEST_F(Drill, TellsWhatHappenedInItsFilesAndStopsWhereItIsAsked) {
  const Json free = drill("");
  EXPECT_EQ(free["stopped"], false);
  const double max_n = free["max_thrust_n"].get<double>();
  ASSERT_GT(max_n, 1.0);
  const Json stopped = drill("--stop-at-thrust " + std::to_string(0.5 * max_n));
  EXPECT_EQ(stopped["stopped"], true);
  EXPECT_LT(stopped["max_depth_mm"].get<double>(), free["max_depth_mm"].get<double>() - 1.0);
  std::ifstream events(folder_->path() / "out" / "events.csv");
  const std::string text((std::istreambuf_iterator<char>(events)), std::istreambuf_iterator<char>());
  EXPECT_NE(text.find("\nstop: thrust,"), std::string::npos);
  EXPECT_NE(text.find("\nstate,"), std::string::npos);
}

TEST_F(Drill, StopsOnABreachOfTheFarSide) {
  // 3 mm beyond the ball: its outer surface is all the wall there is, since it is no vertebra.
  const DrillPath inside = path({2.0, 20.0, 2.0});
  DrillPath through = inside;
  through.target_mm += 5.0 * through.direction();
  write_plan({through}, folder_->path() / "through.json");
  const Json stopped = drill("--stop-on-breach", "through.json", 1);
  EXPECT_EQ(stopped["stopped"], true);
  EXPECT_NEAR(stopped["max_depth_mm"].get<double>(), 2.0 * kBoneRadiusMm, 0.3);
  EXPECT_LT(stopped["min_clearance_outer_mm"].get<double>(), 0.05);
}

TEST_F(Drill, TakesEveryOperator) {
  EXPECT_EQ(drill("--operator off-path")["operator"]["offset"], "1.2 mm");
  EXPECT_EQ(drill("--operator tilted --tilt 5")["operator"]["tilt"], "5 degrees");
  EXPECT_EQ(drill("--operator tremor --seed 7")["operator"]["tremor"], "0.1 mm, seed 7");
  const test::ProgramRun pushed = test::run_program(
      "drill bone.vdb plan.json --radius 2 --spacing 0.2 -o out --force --json out.json --operator push --push 30 "
      "--no-pictures",
      folder_->path());
  ASSERT_EQ(pushed.exit_code, 0) << pushed.errors;
  EXPECT_EQ(read_json(folder_->path() / "out.json")["operator"]["push"], "30 N");
  // Feed over rate is the step: the same poses either way, and the same bone.
  const Json by_step = drill("");
  const test::ProgramRun by_rate = test::run_program(
      "drill bone.vdb plan.json --radius 2 --spacing 0.2 --feed 1 --rate 100 -o out --force --json out.json "
      "--no-pictures",
      folder_->path());
  ASSERT_EQ(by_rate.exit_code, 0) << by_rate.errors;
  EXPECT_EQ(read_json(folder_->path() / "out.json")["removed"], by_step["removed"]);
  EXPECT_EQ(read_json(folder_->path() / "out.json")["max_thrust_n"], by_step["max_thrust_n"]);
}

TEST_F(Drill, PushesToItsTargetOrSaysWhyNot) {
  const auto pushed = [&](const std::string& options) {
    return test::run_program(
        "drill bone.vdb plan.json --radius 2 --spacing 0.2 -o out --force --json out.json --no-pictures "
        "--operator push " +
            options,
        folder_->path());
  };
  const test::ProgramRun weak = pushed("--push 0.2 --max-push 0.3");
  EXPECT_EQ(weak.exit_code, 1) << weak.errors;
  EXPECT_NE(weak.output.find("gave up"), std::string::npos);
  const Json figures = read_json(folder_->path() / "out.json");
  EXPECT_EQ(figures["operator_end"], "stood still");
  EXPECT_EQ(figures["events"].back()["event"], "gave up");
  EXPECT_GT(figures["events"].back()["value"].get<double>(), 1.0) << "how far short";
  EXPECT_EQ(pushed("--push 40").exit_code, 0);
  EXPECT_EQ(read_json(folder_->path() / "out.json")["operator_end"], "as planned");
  EXPECT_EQ(test::run_program("drill bone.vdb plan.json --max-push 50 -o out2", folder_->path()).exit_code, 2);
}

TEST_F(Drill, BendsACompliantBit) {
  EXPECT_EQ(drill("")["max_off_mm"], 0.0);
  // Off the path the hole's wall pushes on one side alone.
  const Json bent = drill("--compliant --operator tilted --free-length 60");
  EXPECT_GT(bent["max_off_mm"].get<double>(), 0.0);
  EXPECT_LT(bent["max_off_mm"].get<double>(), 5.0);
  EXPECT_EQ(test::run_program("drill bone.vdb plan.json --stall-torque 50 -o out2", folder_->path()).exit_code, 2);
}

TEST_F(Drill, FollowsPosesFromAFile) {
  const DrillPath drilled = path({});
  const Vec3 axis = drilled.direction();
  std::ofstream csv(folder_->path() / "poses.csv");
  csv << "time_s,x_mm,y_mm,z_mm,axis_x,axis_y,axis_z\n";
  for (int n = 0; n <= 700; ++n) {
    const Vec3 tip = drilled.entry_mm + (-3.0 + 0.01 * n) * axis;
    csv << 0.01 * n << ',' << tip.x() << ',' << tip.y() << ',' << tip.z() << ',' << axis.x() << ',' << axis.y() << ','
        << axis.z() << '\n';
  }
  csv.close();
  const test::ProgramRun run = test::run_program(
      "drill bone.vdb plan.json --radius 2 --spacing 0.2 --operator poses.csv -o out --force --json out.json",
      folder_->path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json figures = read_json(folder_->path() / "out.json");
  EXPECT_EQ(figures["cycles"], 700);
  EXPECT_NEAR(figures["max_depth_mm"].get<double>(), 4.0, 1e-3);
  EXPECT_NEAR(figures["session_s"].get<double>(), 7.0, 0.011);
}

TEST_F(Drill, RunsInRealTimeAndRecordsWhatCanBeReplayed) {
  std::filesystem::remove(folder_->path() / "run.h5");
  const std::string options =
      "drill bone.vdb plan.json --radius 2 --spacing 0.2 --operator tremor --feed 10 --rate 500 --real-time --seconds "
      "1 --output-rate 2000 --record run.h5 -o out --json out.json --no-pictures";
  const test::ProgramRun run = test::run_program(options + " --force", folder_->path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json figures = read_json(folder_->path() / "out.json");
  const Json& collision = figures["real_time"]["collision"];
  EXPECT_NEAR(figures["real_time"]["seconds"].get<double>(), 1.0, 0.9);
  EXPECT_EQ(collision["cycles"], figures["cycles"]);
  EXPECT_NEAR(collision["cycles"].get<double>() + collision["idle"].get<double>() + collision["skipped"].get<double>(),
              500.0 * figures["real_time"]["seconds"].get<double>(), 5.0);
  EXPECT_GT(figures["real_time"]["display"]["cycles"].get<int>(), 0);
  EXPECT_GT(figures["real_time"]["output"]["cycles"].get<int>(), 500);
  EXPECT_NE(run.output.find("collision, work, CPU"), std::string::npos) << run.output;
  // Nothing is written over unasked; and it brings the same again.
  const test::ProgramRun again = test::run_program(options, folder_->path());
  EXPECT_NE(again.exit_code, 0);
  EXPECT_NE(again.errors.find("run.h5"), std::string::npos) << again.errors;
  const test::ProgramRun replay = test::run_program("replay run.h5 bone.vdb --engine leaf", folder_->path());
  EXPECT_EQ(replay.exit_code, 0) << replay.output << replay.errors;
}

/// Mean over all cycles of a log, N.
double mean_thrust_n(const std::filesystem::path& log) {
  std::istringstream lines(read_whole_file(log));
  std::string line, field;
  std::getline(lines, line);
  const auto column_called = [&](const std::string& wanted) {
    std::istringstream names(line);
    std::size_t column = 0;
    for (std::string name; std::getline(names, name, ',') && name != wanted;) ++column;
    return column;
  };
  const std::size_t cycles_column = column_called("cycles"), thrust_column = column_called("mean_thrust_n");
  double sum_n = 0.0, cycles = 0.0;
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    double row_cycles = 0.0, row_n = 0.0;
    for (std::size_t n = 0; std::getline(fields, field, ','); ++n) {
      if (n == cycles_column) row_cycles = std::stod(field);
      if (n == thrust_column) row_n = std::stod(field);
    }
    sum_n += row_cycles * row_n;
    cycles += row_cycles;
  }
  return sum_n / cycles;
}

TEST_F(Drill, DrillsVoxelsOfTheWholeBone) {
  const Json points = drill("--operator tremor");
  const std::filesystem::path log = folder_->path() / "out" / "log.csv";
  // Of a hand that trembles the greatest thrust is a matter of luck.
  const double thrust_n = mean_thrust_n(log);
  EXPECT_GT(points["max_thrust_n"].get<double>(), thrust_n);
  const Json voxels = drill("--engine voxel --operator tremor --record voxels.h5");
  EXPECT_EQ(voxels["engine"], "voxel");
  for (const char* key : {"points", "points_in_bone", "bytes_per_point", "points_per_disc"}) {
    EXPECT_TRUE(points.contains(key)) << key;
    EXPECT_FALSE(voxels.contains(key)) << key;
  }
  EXPECT_EQ(points["unit"], "points");
  EXPECT_EQ(voxels["unit"], "voxels");
  EXPECT_EQ(voxels["voxel_mm"], 0.2);
  const double ball_mm3 = 4.0 / 3.0 * std::numbers::pi * std::pow(kBoneRadiusMm, 3);
  EXPECT_NEAR(0.008 * voxels["voxels_in_bone"].get<double>(), ball_mm3, 0.01 * ball_mm3);
  EXPECT_NEAR(mean_thrust_n(log), thrust_n, 0.15 * thrust_n);
  for (const auto& [engine, exit_code] : {std::pair("voxel", 0), std::pair("ring", 1)}) {
    const test::ProgramRun replay =
        test::run_program(std::string("replay voxels.h5 bone.vdb --engine ") + engine, folder_->path());
    EXPECT_EQ(replay.exit_code, exit_code) << engine << replay.output << replay.errors;
  }
  const std::string report = read_whole_file(folder_->path() / "out" / "report.html");
  EXPECT_THAT(report, HasSubstr("Voxels removed"));
  EXPECT_THAT(report, HasSubstr("Voxels removed at each step"));
  EXPECT_THAT(report, Not(HasSubstr("The bone before and after"))) << "--no-pictures";
  EXPECT_THAT(report, Not(HasSubstr("oints")));
}

TEST_F(Drill, FillsVoxelsOfARegion) {
  const Json whole = drill("--engine voxel --operator tremor");
  const Json near = drill("--region 2.5 --operator tremor --record region.h5");
  EXPECT_EQ(near["engine"], "voxel");
  EXPECT_FALSE(whole.contains("region_mm"));
  ASSERT_TRUE(near.contains("region_mm"));
  EXPECT_LT(near["voxels_in_bone"], whole["voxels_in_bone"]);
  for (const char* key : {"removed", "max_depth_mm", "mesh"}) EXPECT_EQ(near[key], whole[key]) << key;
  for (const char* key : {"max_thrust_n", "max_torque_n_mm"}) {
    EXPECT_NEAR(near[key].get<double>(), whole[key].get<double>(), 1e-9) << key;
  }
  ASSERT_EQ(near["events"].size(), whole["events"].size());
  for (std::size_t n = 0; n < near["events"].size(); ++n) {
    EXPECT_EQ(near["events"][n]["event"], whole["events"][n]["event"]);
    EXPECT_EQ(near["events"][n]["cycle"], whole["events"][n]["cycle"]);
  }
  // The same as a box.
  std::string corners;
  for (const Json& corner : near["region_mm"]) {
    for (const Json& number : corner) corners += (corners.empty() ? "" : ",") + number.dump();
  }
  const Json box = drill("--region=" + corners + " --operator tremor");
  EXPECT_EQ(box["region_mm"], near["region_mm"]);
  EXPECT_EQ(box["voxels_in_bone"], near["voxels_in_bone"]);
  EXPECT_EQ(box["removed"], near["removed"]);
  const test::ProgramRun replay = test::run_program("replay region.h5 bone.vdb", folder_->path());
  EXPECT_EQ(replay.exit_code, 0) << replay.output << replay.errors;
  EXPECT_THAT(read_whole_file(folder_->path() / "out" / "report.html"), HasSubstr("Region"));
}

TEST_F(Drill, TakesTheFastestEngine) {
  EXPECT_EQ(drill("")["engine"], "ring");
  const Json leaf = drill("--tilt 20"), ring = drill("--tilt 20 --engine ring");
  EXPECT_EQ(leaf["engine"], "leaf");
  EXPECT_EQ(ring["engine"], "ring");
  EXPECT_EQ(leaf["removed"], ring["removed"]);
}

TEST_F(Drill, MillsAPatchDownToAFloor) {
  // From a side that no axis goes along.
  const Vec3 into = Vec3(-1.0, 2.0, 2.0) / 3.0, aside = into.cross(Vec3::UnitX()).normalized();
  const Vec3 top_mm = kBoneCentre - kBoneRadiusMm * into;
  constexpr double kHalfMm = 5.5, kFloorMm = 3.0;
  Milling milling;
  milling.name = "cap";
  for (const auto& [x, y] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
    milling.outline_mm.push_back(top_mm + kHalfMm * (x * aside + y * aside.cross(into)));
  }
  milling.into = into;
  milling.depth = Milling::Depth::floor;
  milling.depth_mm = kFloorMm;
  milling.apart_mm = 0.5;
  write_milling(milling, folder_->path() / "cap.json");
  write_plan({{"cap", top_mm - into, top_mm + 5.0 * into, {3.0, 20.0, 1.0, BitShape::round_burr, 0.0, 1.5}}},
             folder_->path() / "cap_plan.json");
  const test::ProgramRun run = test::run_program(
      "drill bone.vdb cap_plan.json --spacing 0.1 --operator cap.json -o cap --json cap_out.json "
      "--full-mesh --record cap.h5",
      folder_->path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json figures = read_json(folder_->path() / "cap_out.json");
  // All that stands on the floor: the patch is wider than the cap there.
  const double cap_mm3 = std::numbers::pi * kFloorMm * kFloorMm * (kBoneRadiusMm - kFloorMm / 3.0);
  EXPECT_NEAR(1e-3 * figures["removed"].get<double>(), cap_mm3, 0.02 * cap_mm3);
  // And so says the mesh, which comes from the distance to the swept tool.
  const double ball_mm3 = 4.0 / 3.0 * std::numbers::pi * std::pow(kBoneRadiusMm, 3);
  EXPECT_NEAR(figures["mesh"]["volume_mm3"].get<double>(), ball_mm3 - cap_mm3, 0.02 * cap_mm3);
  EXPECT_EQ(figures["mesh"]["pieces"], 1);
  EXPECT_EQ(figures["operator"]["milling"], "cap");
  EXPECT_EQ(figures["engine"], "voxel");
  // Layer by layer it comes out of the bone and plunges, which means nothing to it.
  ASSERT_EQ(figures["events"].size(), 1U);
  EXPECT_EQ(figures["events"][0]["event"], "contact");
  EXPECT_TRUE(figures["plunge_depth_mm"].is_null());
  const test::ProgramRun replay = test::run_program("replay cap.h5 bone.vdb", folder_->path());
  EXPECT_EQ(replay.exit_code, 0) << replay.output << replay.errors;
}

TEST_F(Drill, CutsAKerfWithASawAndReplaysIt) {
  DrillPath cut = path({});
  cut.bit = plate_bit(20.0, 1.0, 30.0, 2.0);  // wider than the ball
  // Its faces lie along no layers of voxels that are far between: by those a kerf counts too wide or too narrow.
  cut.bit.width_along = Vec3(0.31, 0.52, 0.79).normalized();
  write_plan({cut}, folder_->path() / "saw.json");
  const test::ProgramRun run = test::run_program(
      "drill bone.vdb saw.json --spacing 0.1 --step 0.02 --no-clearances --record saw.h5 -o saw --json saw_out.json",
      folder_->path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json figures = read_json(folder_->path() / "saw_out.json");
  EXPECT_EQ(figures["engine"], "voxel");
  EXPECT_EQ(figures["unit"], "voxels");
  EXPECT_EQ(figures["bit"]["shape"], "plate");
  EXPECT_EQ(figures["bit"]["width_mm"], 20.0);
  EXPECT_EQ(figures["bit"]["thickness_mm"], 1.0);
  // A slab of the ball, 1 mm thick, as deep as its edge came: up to 2 mm before the far side.
  double kerf_mm3 = 0.0;
  constexpr int kLayers = 1000;
  for (int n = 0; n < kLayers; ++n) {
    const double off_mm = (n + 0.5) / kLayers - 0.5;
    const double radius_mm = std::sqrt(kBoneRadiusMm * kBoneRadiusMm - off_mm * off_mm);
    const double left_mm = radius_mm - (kBoneRadiusMm - 2.0);  // of the disc, uncut
    const double angle = std::acos(1.0 - left_mm / radius_mm);
    const double segment_mm2 = radius_mm * radius_mm * (angle - std::sin(angle) * std::cos(angle));
    kerf_mm3 += (std::numbers::pi * radius_mm * radius_mm - segment_mm2) / kLayers;
  }
  EXPECT_NEAR(1e-3 * figures["removed"].get<double>(), kerf_mm3, 0.01 * kerf_mm3);
  const std::string report = read_whole_file(folder_->path() / "saw" / "report.html");
  EXPECT_THAT(report, HasSubstr("Saw, width × thickness × length"));
  EXPECT_THAT(report, HasSubstr("20.0 × 1.0 × 30.0"));
  EXPECT_THAT(report, HasSubstr("The bone before and after"));
  EXPECT_THAT(report, Not(HasSubstr("conical tip")));
  EXPECT_THAT(run.output, HasSubstr("20.0 × 1.0 × 30.0 mm"));
  const test::ProgramRun replay = test::run_program("replay saw.h5 bone.vdb", folder_->path());
  EXPECT_EQ(replay.exit_code, 0) << replay.output << replay.errors;
  const test::ProgramRun by_points = test::run_program("replay saw.h5 bone.vdb --engine ring", folder_->path());
  EXPECT_EQ(by_points.exit_code, 2);
  EXPECT_THAT(by_points.errors, HasSubstr("a plate"));
  ASSERT_EQ(test::run_program("export saw.h5 -o saw.csv", folder_->path()).exit_code, 0);
  EXPECT_THAT(read_whole_file(folder_->path() / "saw.csv"), HasSubstr("side_x,side_y,side_z\n"));
  for (const char* options : {"--engine ring", "--points", "--splats", "--rbf none.rbf"}) {
    const test::ProgramRun failed =
        test::run_program(std::string("drill bone.vdb saw.json --force -o saw_failed ") + options, folder_->path());
    EXPECT_EQ(failed.exit_code, 2) << options;
    EXPECT_THAT(failed.errors, HasSubstr("plate")) << options;
  }
}

TEST_F(Drill, SaysWhichOptionsDoNotGoTogether) {
  const auto rejected = [&](const std::string& options, const std::string& word) {
    const test::ProgramRun run = test::run_program("drill bone.vdb plan.json -o rejected " + options, folder_->path());
    EXPECT_NE(run.exit_code, 0) << options;
    EXPECT_NE(run.errors.find(word), std::string::npos) << options << ": " << run.errors;
    EXPECT_FALSE(std::filesystem::exists(folder_->path() / "rejected")) << options;
  };
  rejected("--operator sideways", "found \"sideways\"");
  rejected("--operator on-path --offset 1", "take off-path");
  rejected("--operator push --feed 2", "feed follows from the bone");
  rejected("--push 20", "only the operator push");
  rejected("--operator none.csv", "none.csv");
  rejected("--operator none.json", "none.json");
  rejected("--operator plan.json", "milling");
  rejected("--operator cap.json --stop-on-breach", "takes the walls away");
  rejected("--operator cap.json --feed 2", "the file says where");
  rejected("--operator none.csv --tremor 0.1", "the file says where");
  rejected("--step 0.01 --feed 1 --rate 100", "two of --step, --feed and --rate");
  rejected("--real-time --step 0.01", "no --step with --real-time");
  rejected("--seconds 5", "expected --real-time");
  rejected("--output-rate 5000", "expected --real-time");
  rejected("--real-time --rate 50000", "1 to 20,000 Hz");
  rejected("--real-time --seconds 0", "above 0 s");
  rejected("--stop-on-breach --no-clearances", "leave --no-clearances away");
  rejected("--record run2.h5 --rbf none.rbf", "without --rbf");
  rejected("--engine voxel --points", "an engine of points with --points");
  rejected("--engine voxel --jitter 0.1", "expected no jitter");
  rejected("--region 5 --engine ring", "only voxels can fill one");
  rejected("--region 5 --points", "an engine of points with --points");
  rejected("--region 0", "expected a distance from the path above 0 mm");
  rejected("--region 1,2,3", "expected --region as a distance");
  rejected("--region near", "found \"near\"");
  rejected("--region 5,5,5,1,1,1", "whose second corner lies beyond its first");
  rejected("--region 900,900,900,910,910,910", "expected a region with bone in it");
  rejected("--feed 1:x", "expected --feed");
  rejected("--feed 0", "0 mm/s");
  rejected("--tremor -1", "tremor");
  rejected("--spindle -5", "turns a minute");
  EXPECT_FALSE(std::filesystem::exists(folder_->path() / "run2.h5"));
}

TEST_F(Drill, RejectsOptionsWithoutSense) {
  for (const char* options : {"--jitter 0.7", "--engine fast", "--hu-bits 12", "--fine-spacing -1", "--rbf none.rbf",
                              "--subdivision squares"}) {
    const test::ProgramRun run =
        test::run_program(std::string("drill bone.vdb plan.json -o rejected ") + options, folder_->path());
    EXPECT_NE(run.exit_code, 0) << options;
    EXPECT_FALSE(run.errors.empty()) << options;
    EXPECT_FALSE(std::filesystem::exists(folder_->path() / "rejected")) << options;
  }
}

}  // namespace
}  // namespace spinaltap
