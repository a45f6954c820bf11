#include <memory>
#include <nlohmann/json.hpp>

#include "apps/report/heat_figures.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/heat_options.h"
#include "apps/spinaltap/level_output.h"
#include "core/base/staged_output.h"
#include "core/files/recorded_setup.h"
#include "vdb/sim/solve_heat.h"

namespace spinaltap {
namespace {

struct SolveOptions {
  std::filesystem::path record, bone;
  Level level = Level::kNone;
  std::filesystem::path output = "heat.vdb";
  std::filesystem::path volume;  ///< empty: none
  HeatChoice heat;
  double voxel_mm = SolveHeatOptions().voxel_mm;
  double max_rest_s = DrillingHeatOptions().max_rest_s;
  bool fails_on_harm = false;
};

Json solve(const SolveOptions& options, const Progress& progress, int& exit_code) {
  const SessionRecord record = read_record(options.record);
  const Bone bone = Bone::load(options.bone, options.level);
  SolveHeatOptions how;
  how.voxel_mm = options.voxel_mm;
  how.run.max_rest_s = options.max_rest_s;
  const std::optional<HeatOptions> own = recorded_setup(record.setup, options.record).options.heat;
  how.heat = options.heat.is_given() || !own ? options.heat.options() : *own;
  const SolvedHeat heat = solve_heat(record, options.record, bone, how, progress);

  StagedOutput output;
  heat.grid->write(output.stage(options.output), heat.heat.bone.temperature_c);
  if (!options.volume.empty()) write_heat_volume(heat, output.stage(options.volume));
  output.commit();

  print_heat(heat);
  print_figure("written", options.output.string());
  if (options.fails_on_harm && heat.harmed_mm3[0] + heat.harmed_mm3[1] > 0.0) exit_code = kAnswerIsNo;
  Json json = heat_json(heat);
  json["voxel_mm"] = options.voxel_mm;
  json["voxels"] = heat.grid->voxels();
  return json;
}

}  // namespace

void print_heat(const SolvedHeat& heat) {
  for (const auto& [name, value, unit] : heat_rows(heat)) {
    std::string label = name, shown = value;
    label.front() = static_cast<char>(label.front() - 'A' + 'a');
    shown.append(" ").append(unit);
    print_figure(label, shown);
  }
}

void add_heat(CLI::App& program, Command& command) {
  const auto options = std::make_shared<SolveOptions>();
  CLI::App* app =
      add_command(program, command, "heat", "Solve how warm the bone gets around a recorded drilling's hole, on a grid",
                  "Example: spinaltap heat run.h5 bone.vdb -o heat.vdb --irrigation\n"
                  "Writes the grids max_temperature (°C), seconds_hot_0 (s above 47 °C) and seconds_hot_1 (s above 50 "
                  "°C). What the\n"
                  "record says of heat holds unless --irrigation or --thermal-bone is given.");
  app->add_option("record", options->record, "A record of drill --record")->required()->type_name("RECORD");
  app->add_option("bone", options->bone, "The bone.vdb or spine.vdb that was drilled")->required()->type_name("BONE");
  add_level(*app, options->level);
  app->add_option("-o,--output", options->output, "The grids to write, for Blender, Houdini, ParaView: .vdb")
      ->capture_default_str()
      ->type_name("FILE");
  app->add_option("--volume", options->volume,
                  "Also write the max temperature as a volume, °C, for 3D Slicer and ParaView: .nrrd")
      ->type_name("FILE");
  options->heat.add_to(*app);
  app->add_option("--voxel", options->voxel_mm, "Size of the grid's voxels, mm")
      ->capture_default_str()
      ->check(CLI::PositiveNumber)
      ->type_name("MM");
  app->add_option("--max-rest", options->max_rest_s,
                  "After the drilling, wait at most so long until all bone is below 47 °C, s")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber)
      ->type_name("S");
  app->add_flag("--fail-on-harm", options->fails_on_harm,
                "The exit code is 1 where bone was above 47 °C for 60 s, or above 50 °C for 30 s");
  command.outputs = [options] { return std::vector{options->output, options->volume}; };
  command.run = [options, &command](const Progress& progress) { return solve(*options, progress, command.exit_code); };
}

}  // namespace spinaltap
