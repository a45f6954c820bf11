#include "vdb/sim/solve_heat.h"

#include <utility>

#include "core/base/error.h"
#include "core/base/file_stream.h"
#include "core/ct/nrrd_head.h"
#include "core/files/recorded_setup.h"
#include "core/tool/path_curve.h"
#include "vdb/remaining/hole_cutter.h"

namespace spinaltap {

HeatOptions heat_of(const SessionSetup& setup, const SolveHeatOptions& options) {
  if (options.heat) return *options.heat;
  return setup.options.heat.value_or(HeatOptions());
}

SolvedHeat solve_heat(const BoneModel& before, const SessionSetup& setup, std::span<const HeatStep> steps,
                      const SolveHeatOptions& options, const Progress& progress) {
  constexpr std::array kDistancesMm{0.0, 0.5, 1.0, 2.0, 3.0, 5.0};
  if (!setup.options.follows_path) fail("heat: expected a hole along a path, found a milling");
  if (!setup.further_bone_hashes.empty()) {
    fail("heat: expected a drilling of one bone, found one of ", 1 + setup.further_bone_hashes.size());
  }
  SolvedHeat solved;
  solved.heat = heat_of(setup, options);
  check_heat_options(solved.heat);
  const ThermalBone& bone = solved.heat.bone;
  if (!(bone.temperature_c < kHarmfulC[0])) {
    fail("heat: expected bone that is cooler than ", kHarmfulC[0], " °C at first, found ", bone.temperature_c, " °C");
  }
  solved.medium = std::make_unique<BoneMedium>(before, setup.material.density, bone);
  HeatGridOptions grid;
  grid.voxel_mm = options.voxel_mm;
  grid.origin_mm = setup.path.entry_mm;
  grid.axes = axes_along(setup.path.direction());
  grid.wall_transfer_w_mm2_k = solved.heat.is_irrigated ? bone.water_w_mm2_k : 0.0;
  grid.hot_rise_k = {kHarmfulC[0] - bone.temperature_c, kHarmfulC[1] - bone.temperature_c};
  solved.grid = std::make_unique<HeatGrid>(*solved.medium, grid);
  solved.drilling = run_drilling_heat(*solved.grid, setup.path.bit, steps, options.run, progress);

  const HottestVoxel& hottest = solved.drilling.hottest;
  solved.hottest_c = bone.temperature_c + hottest.rise_k;
  solved.hottest_mm = hottest.at_mm;
  solved.hottest_depth_mm = PathCurve(setup.path).nearest_mm(hottest.at_mm);
  for (const double distance_mm : kDistancesMm) {
    solved.distances.push_back({distance_mm, bone.temperature_c + solved.grid->hottest(distance_mm).rise_k});
  }
  solved.harmed_mm3 = {solved.drilling.hot_60_s_mm3, solved.drilling.hot_30_s_mm3};
  return solved;
}

SolvedHeat solve_heat(const SessionRecord& record, const std::filesystem::path& file, const Bone& bone,
                      const SolveHeatOptions& options, const Progress& progress) {
  const SessionSetup setup = recorded_setup(record.setup, file);
  if (record.cycles.empty()) fail(file.string(), " holds no cycle: nothing was drilled yet");
  if (bone.hash() != setup.bone_hash) {
    fail("expected the bone that was drilled in ", file.string(), ", of hash ", setup.bone_hash, "; found one of hash ",
         bone.hash());
  }
  const std::vector<HeatStep> steps =
      heat_steps(record.cycles, setup.path.bit, setup.options.spindle.rpm, heat_of(setup, options).bone);
  return solve_heat(without_holes(bone.model(), setup.holes), setup, steps, options, progress);
}

void write_heat_volume(const SolvedHeat& heat, const std::filesystem::path& staged) {
  const HeatVolume volume = heat.grid->volume();
  std::vector<float> temperatures_c(volume.max_rise_k.size());
  for (std::size_t n = 0; n < temperatures_c.size(); ++n) {
    temperatures_c[n] = static_cast<float>(heat.heat.bone.temperature_c + static_cast<double>(volume.max_rise_k[n]));
  }
  FileWriter file(staged);
  file.write(nrrd_head(volume.geometry, "float", "raw") + "\n");
  file.write({reinterpret_cast<const char*>(temperatures_c.data()), temperatures_c.size() * sizeof(float)});
  file.close();
}

}  // namespace spinaltap
