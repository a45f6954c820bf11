#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>

#include "apps/spinaltap/command.h"
#include "apps/spinaltap/ct_options.h"
#include "apps/spinaltap/drill_run.h"
#include "apps/spinaltap/input_warnings.h"
#include "apps/spinaltap/level_output.h"
#include "apps/spinaltap/mesh_figures.h"
#include "apps/spinaltap/path_options.h"
#include "apps/spinaltap/phantom_options.h"
#include "apps/spinaltap/placement_options.h"
#include "apps/spinaltap/plan_check.h"
#include "apps/spinaltap/report_options.h"
#include "apps/spinaltap/stage_times.h"
#include "core/base/staged_output.h"
#include "core/files/plan_file.h"
#include "mesh/display_mesh.h"
#include "mesh/mesh_io.h"
#include "mesh/surface_comparison.h"
#include "vdb/grid/isosurface.h"
#include "vdb/sim/bone.h"

namespace spinaltap {
namespace {

struct DemoOptions {
  std::filesystem::path folder = "spinaltap-demo";
  CtOptions ct;
  PathOptions path;
  DrillOptions drill;
  PhantomCommandOptions phantom;
  std::string command;  ///< as the reports show it
};

std::string level_or(Level level, const std::string& otherwise) {
  return level == Level::kNone ? otherwise : level_name(level);
}

void heading(const char* text) { std::printf("%s\n", text); }

/// spinaltap-demo, or spinaltap-demo-2 and so on where that holds an earlier demonstration, or anything else.
std::filesystem::path free_folder(const std::filesystem::path& wanted) {
  namespace fs = std::filesystem;
  fs::path folder = wanted;
  for (int n = 2; fs::exists(fs::symlink_status(folder)) && !(fs::is_directory(folder) && fs::is_empty(folder)); ++n) {
    folder = wanted.string() + "-" + std::to_string(n);
  }
  return folder;
}

/// What is typed for this program here.
std::string program_as_typed() {
  namespace fs = std::filesystem;
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path().parent_path() / "bin/spinaltap";
  const std::string from_here = fs::proximate(program).string();
  return from_here.starts_with("..") ? program.string() : from_here;
}

void say_what_to_open(const std::filesystem::path& page) {
  std::printf("open  %s\n", std::filesystem::absolute(page).lexically_normal().c_str());
}

/// The last lines: what to look at, and what to type next.
void say_what_next(const DemoOptions& options, bool is_phantom) {
  const std::string program = program_as_typed();
  const std::string bone = (options.folder / "bone.vdb").string(), plan = (options.folder / "plan.json").string();
  say_what_to_open(options.folder / "report.html");
  std::printf("next: %s drill %s %s --operator push -o pushed    # with a force: the feed follows from the bone\n",
              program.c_str(), bone.c_str(), plan.c_str());
  if (is_phantom) {
    std::printf(
        "next: %s demo path/to/dicom --seed-point X,Y,Z    # your CT; a point in the vertebra's body, LPS, mm\n",
        program.c_str());
  } else {
    std::printf("next: %s grade %s %s -o graded    # clearances and grades of its paths\n", program.c_str(),
                bone.c_str(), plan.c_str());
  }
}

Json demo(DemoOptions options, const Progress& progress, int& exit_code) {
  Json figures = Json::object();
  StageClock clock;
  std::optional<Phantom> phantom;
  std::vector<DrillPath> paths;
  if (options.ct.folder.empty()) {
    heading("Phantom");
    phantom = options.phantom.make();
    const std::filesystem::path folder = options.folder / "phantom";
    write_phantom(*phantom->solid, phantom->ground_truth, options.phantom.output_options(), folder, progress);
    options.ct.folder = folder / "ct";
    if (phantom->ground_truth) paths = read_plan(folder / "plan.json");
    print_figure("written", folder.string());
    clock.end("phantom");
  }

  heading("CT to bone");
  const std::optional<CtVolume> ct = options.ct.read(progress);
  clock.end("read");
  const BakedCt baked = options.ct.make_bone(*ct, progress);
  clock.take(baked.times);
  figures["bake"] = report_baked(*ct, baked);
  const std::vector<std::string> of_input = input_warnings_in(baked.bone.metadata());
  report_input_warnings(of_input, figures);
  const TriangleMesh mesh =
      options.drill.writes_full_mesh ? bone_surface(baked.bone) : display_mesh(baked.bone, {}, nullptr, progress);
  figures["mesh"] = report_mesh(measure_mesh(mesh));
  if (phantom) {
    const SurfaceError error = surface_error(bone_surface(baked.bone), *phantom->solid);
    print_figure("distance to the ground truth, mean", error.mean_mm, "mm", 3);
    print_figure("distance to the ground truth, 99 %", error.p99_mm, "mm", 3);
    figures["ground_truth"] = {{"mean_mm", error.mean_mm}, {"p99_mm", error.p99_mm}, {"bias_mm", error.bias_mm}};
  }
  StagedOutput output;  // of the whole demonstration: each part is shown when it is there
  write_bone(baked.bone, output.stage(options.folder / "bone.vdb"));
  write_mesh(mesh, output.stage(options.folder / "bone.stl"));
  clock.end("meshed");

  const Bone bone(baked.bone);
  heading("Plan");
  PlanFindings findings;
  if (std::optional<DrillPath> given = options.path.given_path("given")) {
    given->bone = bone.identity();
    paths = {*given};
    findings = check_plan(bone, paths, {});
  } else if (paths.empty()) {
    const std::vector<Suggestion> suggestions = bone.suggest(
        {.bit = options.path.bit(), .density = options.drill.density, .material = options.drill.material}, progress);
    std::vector<GradedPath> graded = graded_paths(suggestions);
    add_uncertainty(bone, PlacementOptions().model(), graded, progress);
    figures["plan"] = report_suggestions(bone, suggestions, graded);
    CtVolume kept;
    write_planning_report(report_head(level_or(baked.level, "Suggested paths"), options.command, bone, ct, kept),
                          suggestions, graded, {}, options.folder / "plan.html", progress);
    output.also_list(options.folder / "plan.html");
    if (graded.empty()) {  // nothing to drill
      output.commit();
      clock.end("planned");
      figures["times"] = report_times(clock);
      say_what_to_open(options.folder / "plan.html");
      exit_code = kAnswerIsNo;
      return figures;
    }
    paths = paths_of(suggestions);
  }
  figures["plan"].update(report_paths(paths));
  write_plan(paths, options.folder / "plan.json");
  output.also_list(options.folder / "plan.json");
  clock.end("planned");

  heading("Drilling");
  const std::string title = "Drilling " + (phantom ? "the phantom" : level_or(baked.level, "a vertebra"));
  figures["drill"] = run_drill({title, options.command, &*ct}, {&bone, 1}, paths.front(), options.drill, options.folder,
                               output, clock, progress);
  const bool accepts_warnings = options.ct.finding.accepts_warnings;
  exit_code = say_input_warnings(of_input, accepts_warnings);
  add_findings(bone, findings, figures["plan"]);
  exit_code = std::max(exit_code, say_findings(findings, options.ct.finding.accepts_warnings));
  if (baked.warnings) {
    exit_code = std::max(exit_code, say_suspect(level_name(baked.level), *baked.warnings, accepts_warnings));
  }
  figures["times"] = report_times(clock);
  say_what_next(options, phantom.has_value());
  return figures;
}

}  // namespace

void add_demo(CLI::App& program, Command& command) {
  const auto options = std::make_shared<DemoOptions>();
  CLI::App* app = add_command(program, command, "demo",
                              "Run the whole chain, from a CT to a drilled bone: on a phantom, or on your own CT",
                              "Examples: spinaltap demo\n"
                              "          spinaltap demo ct/ --labels vertebrae.nii.gz --label 22 -o out/");
  app->add_option("ct", options->ct.folder,
                  "Folder with a DICOM CT series, or a NIfTI, NRRD or MetaImage file; default: a phantom")
      ->type_name("PATH");
  CLI::Option* const output =
      app->add_option("-o,--output", options->folder,
                      "Folder for the results; where it is left out and the default is there already, the next free\n"
                      "one: spinaltap-demo-2, ...")
          ->capture_default_str()
          ->type_name("FOLDER");
  options->ct.add_reading(*app);
  options->ct.add_baking(*app);
  options->path.add_to(*app);
  options->drill.add_to(*app);

  app->parse_complete_callback([options, output, app, &command] {
    options->command = shown_command(*app);
    if (output->count() > 0 || command.is_forced) return;
    options->folder = free_folder(options->folder);
    output->default_str(options->folder.string());  // what is asked whether it is there
  });
  command.after_stop = "at most the phantom was written; the same command begins again, in a folder of its own";
  command.run = [options, &command](const Progress& progress) { return demo(*options, progress, command.exit_code); };
}

}  // namespace spinaltap
