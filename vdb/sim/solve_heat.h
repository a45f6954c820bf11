#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/session/record/session_record.h"
#include "core/session/session_setup.h"
#include "vdb/heat/drilling_heat.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

struct SolveHeatOptions {
  /// How bone takes up heat, and water; none: as the setup has it, else the defaults, dry.
  std::optional<HeatOptions> heat = {};
  double voxel_mm = 0.2;
  DrillingHeatOptions run = {};
};

/// The hottest bone so far away from the hole's wall, or further.
struct HeatAtDistance {
  double distance_mm = 0.0;
  double temperature_c = 0.0;
};

/// Above what, and for how long in all, bone counts as harmed.
inline constexpr std::array<double, 2> kHarmfulC{47.0, 50.0};
inline constexpr std::array<double, 2> kHarmfulS{60.0, 30.0};

/// What the heat of a drilling came to in the bone that is there at its end, solved on a grid around the hole.
struct SolvedHeat {
  HeatOptions heat;
  std::unique_ptr<const HeatMedium> medium;  ///< that the grid stands on
  std::unique_ptr<HeatGrid> grid;
  DrillingHeat drilling;  ///< rises: from heat.bone.temperature_c

  double hottest_c = 0.0;          ///< as far as voxels tell: at the wall
  Vec3 hottest_mm = Vec3::Zero();  ///< where: patient LPS
  double hottest_depth_mm = 0.0;   ///< and along the path, 0 at the entry
  std::vector<HeatAtDistance> distances;
  std::array<double, 2> harmed_mm3{};  ///< hotter than kHarmfulC for kHarmfulS
};

/// Heat of a drilling that a session of `setup` did in `before`, the bone without the setup's earlier holes, in `steps`
/// (heat_steps()). Throws Error on a tool that drills no hole, a milling, several bones and bad options. Can be
/// cancelled.
SolvedHeat solve_heat(const BoneModel& before, const SessionSetup& setup, std::span<const HeatStep> steps,
                      const SolveHeatOptions& options = {}, const Progress& progress = {});
/// The same of a record of `file`, in the bone that was drilled. Throws Error where it is another, too.
SolvedHeat solve_heat(const SessionRecord& record, const std::filesystem::path& file, const Bone& bone,
                      const SolveHeatOptions& options = {}, const Progress& progress = {});

/// What solve_heat() takes of the setup's heat.
HeatOptions heat_of(const SessionSetup& setup, const SolveHeatOptions& options);

/// The hottest that each place was, °C, as an NRRD volume of floats along the hole, to a staged file: 3D Slicer and
/// ParaView read it. Throws Error when the disk is full.
void write_heat_volume(const SolvedHeat& heat, const std::filesystem::path& staged);

}  // namespace spinaltap
