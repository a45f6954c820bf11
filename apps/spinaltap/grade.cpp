#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "apps/report/grade_output.h"
#include "apps/report/grade_report.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/input_warnings.h"
#include "apps/spinaltap/level_output.h"
#include "apps/spinaltap/placement_options.h"
#include "apps/spinaltap/plan_check.h"
#include "apps/spinaltap/report_options.h"
#include "core/base/staged_output.h"
#include "core/files/data_files.h"
#include "core/files/material_file.h"
#include "core/files/plan_file.h"
#include "vdb/grid/bone_model.h"
#include "vdb/sim/bone.h"

namespace spinaltap {
namespace {

struct GradeCommandOptions {
  std::filesystem::path bone, plan, density, material;
  Level level = Level::kNone;
  std::string path_name;
  double screw_diameter_mm = std::nan("");
  double screw_length_mm = std::nan("");
  GradeOptions grade;
  PlacementOptions placement;
  PageOptions page;
  PlanCheckOptions check;
  std::filesystem::path folder = "graded";
  bool fails_on_breach = false;
};

std::vector<DrillPath> chosen_paths(const GradeCommandOptions& options) {
  std::vector<DrillPath> paths = read_plan(options.plan);
  if (!options.path_name.empty()) paths = {choose_path(paths, options.path_name)};
  if (std::isnan(options.screw_diameter_mm)) return paths;
  for (DrillPath& path : paths) {
    PedicleScrew screw = path.screw.value_or(PedicleScrew());
    if (screw.diameter_mm != options.screw_diameter_mm || screw.length_mm != options.screw_length_mm) screw.name = "";
    if (screw.diameter_mm != options.screw_diameter_mm) screw.thread.reset();  // that of the other
    screw.diameter_mm = options.screw_diameter_mm;
    screw.length_mm = options.screw_length_mm;
    check_screw(screw);
    path.screw = screw;
  }
  return paths;
}

Json grade(const GradeCommandOptions& options, const Progress& progress, int& exit_code) {
  const std::vector<DrillPath> paths = chosen_paths(options);
  const DensityCalibration density =
      read_density_calibration(options.density.empty() ? data_file("densities/vertebra.json") : options.density);
  const Material material =
      read_material(options.material.empty() ? data_file("materials/vertebra.json") : options.material, density.line);
  const PlacementModel model = options.placement.model();
  const Bone bone = Bone::load(options.bone, options.level);
  PlanFindings findings = check_plan(bone, paths, options.check);
  check_registration(model, bone, options.check, findings);
  std::vector<GradedPath> graded;
  graded.reserve(paths.size());
  for (const DrillPath& path : paths) {
    DrillPath taken = path;
    taken.bone = {};  // which bone it names was looked at
    graded.push_back({path, grade(bone, taken, options.grade, material, progress)});
  }
  add_uncertainty(bone, model, graded, progress);
  const auto is_breach = [](const GradedPath& one) { return one.grade.breach_mm > 0.0; };
  if (options.fails_on_breach && std::any_of(graded.begin(), graded.end(), is_breach)) exit_code = kAnswerIsNo;
  Json figures{{"paths", Json::array()}, {"warnings", bone.landmarks().warnings}};
  report_bone_warnings(bone.model(), figures);
  add_findings(bone, findings, figures);
  Json whole = format_head({.name = "spinaltap-grades"});
  whole.update(figures);
  for (const GradedPath& one : graded) {
    figures["paths"].push_back(to_json(one, options.grade.hu_bands, false));
    whole["paths"].push_back(to_json(one, options.grade.hu_bands, true));
  }
  StagedOutput output;
  output.write(options.folder / "grade.json", whole.dump(2) + "\n");
  output.write(options.folder / "grade.csv", grades_csv(graded, options.grade.hu_bands));
  CtVolume kept;
  const std::optional<CtVolume> ct = options.page.read({&bone, 1}, progress);
  GradeReportData data = report_head(options.page.title_of(bone, "Graded paths"), options.page.command, bone, ct, kept);
  data.paths = graded;
  data.hu_bands = options.grade.hu_bands;
  data.notes = findings.lines();
  output.write(options.folder / "report.html", grade_report(data, progress));
  output.commit();
  std::fputs(grades_table(graded, options.grade.hu_bands).c_str(), stdout);
  print_uncertainty(graded);
  for (const std::string& warning : bone.landmarks().warnings) print_figure("warning", warning);
  if (const int code = say_findings(findings, options.check.accepts_warnings); code != kDone) exit_code = code;
  print_figure("report", (options.folder / "report.html").string());
  return figures;
}

}  // namespace

void add_grade(CLI::App& program, Command& command) {
  const auto options = std::make_shared<GradeCommandOptions>();
  CLI::App* app = add_command(program, command, "grade",
                              "Grade planned paths: clearances, breach, CT numbers and thrust along the depth; writes "
                              "report.html, grade.json and grade.csv",
                              "Example: spinaltap grade bone.vdb plan.json --screw-diameter 6.5 --screw-length 45 "
                              "-o graded/");
  app->add_option("bone", options->bone, "bone.vdb or spine.vdb")->required()->type_name("FILE");
  add_level(*app, options->level);
  app->add_option("plan", options->plan, "plan.json")->required()->type_name("FILE");
  app->add_option("--path", options->path_name, "Name of the path in the plan; default: all")->type_name("NAME");
  CLI::Option* diameter =
      app->add_option("--screw-diameter", options->screw_diameter_mm, "Grade a screw of this diameter on each path, mm")
          ->type_name("MM");
  CLI::Option* length =
      app->add_option("--screw-length", options->screw_length_mm, "Its length, tip included, mm")->type_name("MM");
  diameter->needs(length);
  length->needs(diameter);
  app->add_option("--density", options->density,
                  "Density calibration: a line, or measured pairs; default: the shipped densities/vertebra.json")
      ->type_name("FILE");
  app->add_option("--material", options->material, "Cutting model; default: the shipped materials/vertebra.json")
      ->type_name("FILE");
  app->add_option("--hu-bands", options->grade.hu_bands, "Borders of the bands of CT numbers, HU, ascending")
      ->delimiter(',')
      ->capture_default_str()
      ->type_name("HU,HU");
  app->add_option("--step", options->grade.step_mm, "Depth from row to row, mm")
      ->capture_default_str()
      ->type_name("MM");
  options->placement.add_to(*app);
  options->page.add_to(*app);
  options->check.add_other_ct(*app);
  options->check.add_from_front(*app);
  options->check.add_accept_warnings(*app);
  app->add_flag("--fail-on-breach", options->fails_on_breach, "Exit with 1 where a path breaches, with all written");
  app->add_option("-o,--output", options->folder, "Folder for the results")->capture_default_str()->type_name("FOLDER");
  command.run = [options, &command](const Progress& progress) { return grade(*options, progress, command.exit_code); };
}

}  // namespace spinaltap
