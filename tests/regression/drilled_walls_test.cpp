// States, breakthroughs and operators that push, through real bones: 40 paths that `plan --auto` suggests for two CTs
// of single vertebrae, T2 to T11 of a third, and eight scanned meshes, each on through the far side. Walls are read off
// the bone before it is drilled (tests/support/read_walls.h). The paths were chosen, and half of them looked at (L3,
// T11, T3, T5, T7, T9 and T11 of the spine, L1 of 010 and 016 and of the Visible Human), before the rules were made;
// the others were drilled when they were done. See tests/support/test_data.h for where the data lie.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <set>
#include <string>

#include "core/ct/read_ct.h"
#include "core/segment/segment_spine.h"
#include "core/session/operator/force_controlled.h"
#include "core/session/operator/path_motion.h"
#include "tests/support/read_walls.h"
#include "tests/support/real_meshes.h"
#include "tests/support/test_kind.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/mesh_solid.h"
#include "vdb/sim/bake_levels.h"
#include "vdb/sim/build_session.h"

namespace spinaltap {
namespace {

constexpr double kWallAskedMm = 0.5;
constexpr double kPastFarSideMm = 4.0;
constexpr std::uint64_t kSeeds = 30, kSeedsOfMany = 3;

using test::LineProfile;
using test::WallsMet;

LineProfile profile_along(const Bone& bone, const DrillPath& path) {
  LineProfile profile{-4.0, 0.05, {}, {}};
  std::vector<Vec3> places_mm;
  for (int n = 0; n < 2000; ++n)
    places_mm.push_back(path.entry_mm + profile.at_mm(places_mm.size()) * path.direction());
  const std::vector<float> hu = bone.hu(places_mm);
  const HuToDensity density;
  for (std::size_t n = 0; n < places_mm.size(); ++n) {
    profile.inside_mm.push_back(bone.walls().walls(places_mm[n]).nearer_mm());
    profile.density_g_cm3.push_back(density.density_g_cm3(static_cast<double>(hu[n])));
  }
  return profile;
}

struct WallTally {
  int paths = 0, boundaries = 0, wrong = 0, false_breakthroughs = 0;
  int pushed = 0, reached = 0, said_why = 0, silent = 0;
  double worst_mm = 0.0;
  std::set<std::string> reasons;
};

/// Lock-step at 1 mm/s; what was found of each wall. Leaves `clearances`, for others along the same line.
void drill_through(const Bone& bone, DrillPath path, const std::string& name, WallTally& tally,
                   std::unique_ptr<ClearanceField>& clearances) {
  path.screw.reset();
  path.bit = twist_drill(3.0, 90.0, 118.0, 0.48);
  const WallsMet met = test::read_walls(profile_along(bone, path));
  ASSERT_TRUE(std::isfinite(met.end_mm)) << name;
  path.target_mm = path.entry_mm + (met.end_mm + kPastFarSideMm) * path.direction();
  SessionSetup setup;
  setup.path = path;
  setup.volume.radius_mm = 2.0;
  BuiltSession built = build_session(bone, setup);
  PathMotionOptions motion;
  motion.line.lead_in_mm = 3.0;
  motion.rate_hz = 50.0;
  PlannedMotion planned(path, motion);
  run_session(*built.session, planned);
  double found_mm[4] = {std::nan(""), std::nan(""), std::nan(""), std::nan("")};
  for (const SessionEvent& event : built.session->events()) {
    const auto is_state = [&](DrillState state) {
      return event.kind == EventKind::state && event.value == static_cast<double>(state);
    };
    if (is_state(DrillState::outer_cortical)) found_mm[0] = event.depth_mm;
    if (is_state(DrillState::cancellous) && std::isnan(found_mm[1])) found_mm[1] = event.depth_mm;
    if (is_state(DrillState::inner_cortical)) found_mm[2] = event.depth_mm;
    if (event.kind == EventKind::breakthrough) {
      if (event.depth_mm < met.end_mm - kWallAskedMm) ++tally.false_breakthroughs;
      found_mm[3] = event.depth_mm;
    }
  }
  const double true_mm[4] = {met.outer_mm, met.cortex_end_mm, met.far_cortex_mm, met.end_mm};
  ++tally.paths;
  std::string line;
  for (int n = 0; n < 4; ++n) {
    char text[64];
    const double off_mm = found_mm[n] - true_mm[n];
    std::snprintf(text, sizeof text, "  %6.2f (%6.2f)", found_mm[n], true_mm[n]);
    line += text;
    if (std::isnan(true_mm[n])) continue;  // no such wall: none may be told, but the cancellous state begins somewhere
    ++tally.boundaries;
    if (!(std::abs(off_mm) <= kWallAskedMm)) {
      ++tally.wrong;
      line += " !";
    }
    if (std::isfinite(off_mm)) tally.worst_mm = std::max(tally.worst_mm, std::abs(off_mm));
  }
  std::printf("%-12s%s\n", name.c_str(), line.c_str());
  built.session.reset();
  clearances = std::move(built.clearances);
}

/// Operators of `seeds` seeds push with the default 40 N to the suggested target.
void push_to_target(const Bone& bone, DrillPath path, const std::string& name, std::uint64_t seeds,
                    const ClearanceField& clearances, WallTally& tally) {
  path.screw.reset();
  path.bit = twist_drill(3.0, 90.0, 118.0, 0.48);
  SessionSetup setup;
  setup.path = path;
  setup.volume = {.radius_mm = 2.5, .spacing_mm = 0.2, .lead_in_mm = 3.0};
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    BuiltSession built = build_session(bone, setup, {}, nullptr, &clearances);
    ForceControlled operator_that_pushes(
        path, {.line = {.lead_in_mm = 3.0}, .rate_hz = 500.0, .tremor_mm = 0.1, .seed = seed});
    run_session(*built.session, operator_that_pushes);
    ++tally.pushed;
    const bool reached = operator_that_pushes.depth_mm() >= path.length_mm() - 1e-9;
    const bool says_why = operator_that_pushes.end() != OperatorEnd::as_planned;
    tally.reached += reached ? 1 : 0;
    tally.said_why += !reached && says_why ? 1 : 0;
    tally.silent += !reached && !says_why ? 1 : 0;
    if (!reached) {
      char text[160];
      std::snprintf(text, sizeof text, "%s, seed %d: %s at %.1f of %.1f mm", name.c_str(), static_cast<int>(seed),
                    std::string(name_of(operator_that_pushes.end())).c_str(), operator_that_pushes.depth_mm(),
                    path.length_mm());
      tally.reasons.insert(text);
    }
  }
}

void expect(const WallTally& tally, int paths) {
  std::printf(
      "%d paths, %d walls, %d off by more than %.1f mm, worst %.2f mm, %d false breakthroughs; %d operators, "
      "%d at their target, %d said why not, %d silent\n",
      tally.paths, tally.boundaries, tally.wrong, kWallAskedMm, tally.worst_mm, tally.false_breakthroughs, tally.pushed,
      tally.reached, tally.said_why, tally.silent);
  for (const std::string& reason : tally.reasons) std::printf("  %s\n", reason.c_str());
  EXPECT_EQ(tally.paths, paths);
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_EQ(tally.false_breakthroughs, 0);
  EXPECT_EQ(tally.silent, 0);
}

void drill_both_sides(const Bone& bone, const std::string& name, Level level, std::uint64_t seeds, WallTally& tally) {
  AutoPlanOptions options;
  options.level = level;
  for (const Suggestion& suggestion : bone.suggest(options)) {
    if (!suggestion.best) continue;
    const std::string side_name = name + " " + suggestion.side;
    std::unique_ptr<ClearanceField> clearances;
    drill_through(bone, suggestion.best->path, side_name, tally, clearances);
    ASSERT_TRUE(clearances);
    push_to_target(bone, suggestion.best->path, side_name, seeds, *clearances, tally);
  }
}

WHOLE_RUNS("DrilledWalls.*");

TEST(DrilledWalls, OfL3) {
  SPINALTAP_NEED_TEST_DATA(folder, "L3_ct_1.5mm")
  BakeCtOptions options;
  options.labels = LabelChoice{folder / "sub-ct_seg-vert_label-22_msk.nii.gz", 22};
  const Bone bone(bake_ct(read_ct(folder / "sub-ct_label-22_ct.nii.gz"), options).bone);
  WallTally tally;
  drill_both_sides(bone, "L3", level_from_name("L3").value(), kSeeds, tally);
  expect(tally, 2);
}

TEST(DrilledWalls, OfT11) {
  SPINALTAP_NEED_TEST_DATA(folder, "T11_ct_0.78mm")
  const Bone bone(bake_ct(read_ct(folder / "dicom")).bone);
  WallTally tally;
  drill_both_sides(bone, "T11", level_from_name("T11").value(), kSeeds, tally);
  expect(tally, 2);
}

TEST(DrilledWalls, OfAThoracicSpine) {
  SPINALTAP_NEED_TEST_DATA(folder, "thoracic_spine_ct")
  const CtVolume ct = read_ct(folder / "lidc-0314_spine.nii.gz");
  SpineSegmentation found = segment_spine(ct, {.names = {{level_from_name("T11").value(), Vec3(-9.0, 222.0, -638.0)}}});
  found.labels.names.clear();
  for (const LevelReport& report : found.levels) {
    const int rank = level_rank(report.level);
    if (rank >= level_rank(level_from_name("T2").value()) && rank <= level_rank(level_from_name("T11").value())) {
      found.labels.names[report.label] = {report.name, report.level};
    }
  }
  BakeLevelsOptions options;
  options.finds_landmarks = false;
  WallTally tally;
  for (const BakedLevel& level : bake_levels(ct, found.labels, options).levels) {
    drill_both_sides(Bone(level.baked.bone), level_name(level.level), level.level, kSeedsOfMany, tally);
  }
  expect(tally, 20);
}

TEST(DrilledWalls, OfMeshes) {
  WallTally tally;
  int paths = 0;
  for (const test::RealMesh& real : test::real_meshes()) {
    if (std::string(real.name) == "L2 of VHM" || std::string(real.name) == "L5 of VHM") continue;
    SPINALTAP_NEED_TEST_DATA(file, real.file)
    const std::unique_ptr<Solid> solid = make_mesh_solid(test::read_in_lps(real), {.voxel_mm = 0.25});
    drill_both_sides(Bone(bake_solid(*solid, {}, 40.0)), real.name, real.level, kSeedsOfMany, tally);
    paths += 2;
  }
  expect(tally, paths);
}

}  // namespace
}  // namespace spinaltap
