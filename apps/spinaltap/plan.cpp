#include <cmath>
#include <memory>
#include <optional>
#include <tuple>

#include "apps/report/grade_report.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/input_warnings.h"
#include "apps/spinaltap/level_output.h"
#include "apps/spinaltap/path_options.h"
#include "apps/spinaltap/placement_options.h"
#include "apps/spinaltap/plan_check.h"
#include "apps/spinaltap/plan_levels.h"
#include "apps/spinaltap/report_options.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/text_fields.h"
#include "core/base/text_writer.h"
#include "core/files/bit_file.h"
#include "core/files/data_files.h"
#include "core/files/plan_file.h"
#include "core/files/planning_json.h"
#include "core/files/screw_file.h"
#include "vdb/grid/bone_model.h"
#include "vdb/sim/bone.h"
#include "vdb/sim/bone_path.h"

namespace spinaltap {

void PathOptions::add_to(CLI::App& app) {
  CLI::Option* entry_option =
      app.add_option("--entry", entry_mm, "Entry on the bone's surface: x,y,z in patient LPS, mm")
          ->delimiter(',')
          ->expected(3)
          ->type_name("X,Y,Z");
  app.add_option("--target", target_mm, "Target inside the bone: x,y,z in patient LPS, mm")
      ->delimiter(',')
      ->expected(3)
      ->needs(entry_option)
      ->type_name("X,Y,Z");
  app.add_option("--via", via,
                 "A place that a curved path passes between entry and target: x,y,z in patient LPS, mm; again for each "
                 "further one, in order. Where no bit is said: a ball of 3 mm, the head of a steerable drill")
      ->allow_extra_args(false)
      ->needs(entry_option)
      ->type_name("X,Y,Z");
  CLI::Option* profile_option =
      app.add_option(
             "--bit", profile,
             "Profile of a bit of any outline, in place of its sizes: a file, or match-head, probe, reamer, tap")
          ->type_name("FILE");
  const auto add_size = [&](const std::string& option, double& size_mm, const std::string& what) {
    app.add_option(option, size_mm, what)->capture_default_str()->type_name("MM")->excludes(profile_option);
  };
  add_size("--diameter", sizes.diameter_mm, "Diameter of the bit, mm");
  add_size("--bit-length", sizes.length_mm, "Length of the bit, tip included, mm");
  add_size("--tip-length", sizes.tip_length_mm, "Length of the bit's conical tip, mm");
  app.add_option(
         "--shape", sizes.shape,
         "Shape of the bit: drill (default), round-burr, conical-burr, tapered-screw; plate: a saw, an osteotome")
      ->transform(one_of(bit_shapes()))
      ->type_name("NAME")
      ->excludes(profile_option);
  add_size("--tip-diameter", sizes.tip_diameter_mm,
           "Diameter of the very tip, mm: a twist drill's chisel edge, a conical burr's or a screw's end");
  add_size("--shank-diameter", sizes.shank_diameter_mm, "Diameter of a burr's shank, mm");
  add_size("--wear", sizes.wear_mm, "Height of the flat that wear has ground behind a drill's lips, mm");
  app.add_option("--helix", sizes.helix_deg, "Helix of a drill's flutes at the rim, degrees")
      ->capture_default_str()
      ->type_name("DEG")
      ->excludes(profile_option);
  for (const auto& [name, size_mm, what] :
       {std::tuple("--width", &width_mm, "Width of a plate's cut, mm: of a saw's kerf, with its stroke"),
        std::tuple("--thickness", &thickness_mm, "Thickness of a plate's cut, mm"),
        std::tuple("--stroke", &stroke_mm, "How far a saw's teeth go to and fro, mm; default: 0, an osteotome")}) {
    CLI::Option* option = app.add_option(name, *size_mm, what)->type_name("MM")->excludes(profile_option);
    for (const char* other : {"--diameter", "--tip-length", "--tip-diameter", "--shank-diameter", "--via"}) {
      option->excludes(app.get_option(other));
    }
  }
  app.add_option("--width-along", width_along,
                 "Direction that a plate's width lies along, as nearly as its path lets it: x,y,z in patient LPS; "
                 "default: 0,0,1, up")
      ->delimiter(',')
      ->expected(3)
      ->excludes(profile_option)
      ->type_name("X,Y,Z");
}

DrillBit PathOptions::plate() const {
  if (!width_mm || !thickness_mm) fail("--shape plate was given: expected --width and --thickness too");
  DrillBit plate = plate_bit(*width_mm, *thickness_mm, sizes.length_mm, stroke_mm.value_or(0.0));
  if (!width_along.empty()) {
    const Vec3 along(width_along[0], width_along[1], width_along[2]);
    if (!(along.norm() > 0.0) || !std::isfinite(along.norm())) {
      fail("expected --width-along as a direction that is not zero, found ", along.transpose());
    }
    plate.width_along = along.normalized();
  }
  check_bit(plate);
  return plate;
}

DrillBit PathOptions::bit() const {
  if (!profile.empty()) return read_bit_profile(profile).bit;
  if (sizes.is_plate()) return plate();
  if (width_mm || thickness_mm || stroke_mm || !width_along.empty()) {
    fail("expected --shape plate with --width, --thickness, --stroke and --width-along: other tools turn");
  }
  return !via.empty() && sizes == DrillBit{} ? steerable_head() : sizes;
}

namespace {

Vec3 place_of(const std::string& text) {
  Vec3 place;
  std::size_t begin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t end = axis < 2 ? text.find(',', begin) : text.size();
    const std::optional<double> number =
        end == std::string::npos ? std::nullopt : parse_number(std::string_view(text).substr(begin, end - begin));
    if (!number) fail("expected --via x,y,z, found ", in_quotes(text));
    place[axis] = *number;
    begin = end + 1;
  }
  return place;
}

}  // namespace

std::optional<DrillPath> PathOptions::given_path(const std::string& name) const {
  if (entry_mm.empty()) return std::nullopt;
  if (target_mm.empty()) fail("--entry was given: expected --target x,y,z too");
  DrillPath path{name, Vec3(entry_mm[0], entry_mm[1], entry_mm[2]), Vec3(target_mm[0], target_mm[1], target_mm[2]),
                 bit()};
  for (const std::string& place : via) path.via_mm.push_back(place_of(place));
  const Vec3 direction = (path.target_mm - path.entry_mm).normalized();
  const bool is_plate = path.bit.is_plate() && direction.allFinite();
  if (is_plate && !valid_pose({Vec3::Zero(), direction}, path.bit)) {
    fail(
        "expected a plate whose width lies across its path: choose another --width-along, further than 6 degrees from ",
        "the path's direction ", direction.transpose());
  }
  check_path(path);
  return path;
}

Json report_paths(const std::vector<DrillPath>& paths) {
  Json list = Json::array();
  for (const DrillPath& path : paths) {
    TextWriter text(4);
    text << "(" << path.entry_mm.x() << ", " << path.entry_mm.y() << ", " << path.entry_mm.z() << ") to ("
         << path.target_mm.x() << ", " << path.target_mm.y() << ", " << path.target_mm.z() << "), " << path.length_mm()
         << " mm";
    if (path.is_curved()) text << " along a curve through " << path.via_mm.size() << " places between";
    print_figure("path " + path.name, text.str());
    list.push_back({{"name", path.name},
                    {"entry_mm", to_json(path.entry_mm)},
                    {"target_mm", to_json(path.target_mm)},
                    {"length_mm", path.length_mm()}});
    if (path.is_curved()) {
      list.back()["via_mm"] = Json::array();
      for (const Vec3& via_mm : path.via_mm) list.back()["via_mm"].push_back(to_json(via_mm));
    }
  }
  return {{"paths", list}};
}

namespace {

void add_auto_plan(CLI::App& app, AutoPlanOptions& options) {
  app.add_option("--screws", options.screws, "Table of screw sizes; default: the shipped screws/pedicle.json")
      ->type_name("FILE");
  app.add_option("--rules", options.rules, "Margins and weights; default: the shipped planning/pedicle.json")
      ->type_name("FILE");
  app.add_option("--margin", options.margin_mm,
                 "Bone to keep around the screw, mm, and no less; default: that of the rules, less in narrow pedicles")
      ->type_name("MM");
  app.add_flag("--bicortical", options.is_bicortical, "Let the tip go to the far cortex");
  app.add_option("--sagittal", options.sagittal,
                 "Seen from the side, along the pedicle's axis or the upper endplate: anatomic (default), "
                 "straight-forward")
      ->transform(one_of(sagittal_references()))
      ->type_name("NAME");
  app.add_option("--technique", options.technique, "Only this one: pedicle, in-out-in, cortical; default: as fits")
      ->transform(one_of(techniques()))
      ->type_name("NAME");
}

std::string degrees_and_mm(double mm, double deg) {
  TextWriter text(3);
  text << mm << " mm, " << deg << "°";
  return text.str();
}

void print_suggestion(const Suggestion& suggestion) {
  if (!suggestion.best) {
    print_figure(suggestion.side, "no path: " + suggestion.rejection);
    return;
  }
  const SuggestedPath& best = *suggestion.best;
  print_figure(suggestion.side + " screw", best.path.screw->name);
  print_figure(suggestion.side + " grade", grade_in_words(best.grade));
  print_figure(suggestion.side + " technique", name_of(best.technique));
  for (const std::string& reason : best.reasons) print_figure(suggestion.side + " because", reason);
  for (const Finding& finding : best.grade.findings) {
    print_figure(suggestion.side + (finding.is_warning ? " warning" : " note"), finding.words);
  }
  print_figure(suggestion.side + " clearance, outer surface", best.grade.outer.clearance_mm, "mm");
  print_figure(suggestion.side + " clearance, canal", best.grade.canal.clearance_mm, "mm");
  print_figure(suggestion.side + " convergence", best.angles.convergence_deg, "°", 1);
  print_figure(suggestion.side + " inclination", best.angles.inclination_deg, "°", 1);
  const SafeZone& safe = best.safe;
  print_figure(suggestion.side + " may err medially", degrees_and_mm(safe.medial_mm, safe.medial_deg));
  print_figure(suggestion.side + " may err laterally", degrees_and_mm(safe.lateral_mm, safe.lateral_deg));
  print_figure(suggestion.side + " may err cranially", degrees_and_mm(safe.cranial_mm, safe.cranial_deg));
  print_figure(suggestion.side + " may err caudally", degrees_and_mm(safe.caudal_mm, safe.caudal_deg));
}

void print_landmarks(const Landmarks& marks) {
  print_figure("left pedicle, width", marks.left_pedicle.width_mm, "mm");
  print_figure("right pedicle, width", marks.right_pedicle.width_mm, "mm");
  print_figure("canal, width", marks.canal.width_mm, "mm");
  print_figure("canal, depth", marks.canal.depth_mm, "mm");
  for (const std::string& warning : marks.warnings) print_figure("warning", warning);
}

}  // namespace

std::vector<GradedPath> graded_paths(const std::vector<Suggestion>& suggestions) {
  std::vector<GradedPath> graded;
  for (const Suggestion& suggestion : suggestions) {
    if (suggestion.best) graded.push_back({suggestion.best->path, suggestion.best->grade, suggestion.best->safe});
  }
  return graded;
}

Json report_suggestions(const Bone& bone, const std::vector<Suggestion>& suggestions,
                        const std::vector<GradedPath>& graded) {
  print_landmarks(bone.landmarks());
  Json list = Json::array();
  for (const Suggestion& suggestion : suggestions) {
    print_suggestion(suggestion);
    list.push_back(to_json(suggestion));
    for (const GradedPath& one : graded) {
      if (suggestion.best && one.path.name == suggestion.best->path.name) list.back().update(uncertainty_json(one));
    }
  }
  print_uncertainty(graded);
  return {{"landmarks", to_json(bone.landmarks())}, {"suggestions", list}};
}

std::string planning_report(GradeReportData head, const std::vector<Suggestion>& suggestions,
                            const std::vector<GradedPath>& graded, const std::filesystem::path& screws,
                            const Progress& progress) {
  head.paths = graded;
  head.hu_bands = GradeOptions().hu_bands;
  for (const Suggestion& suggestion : suggestions) {
    if (suggestion.best) {
      head.reasons.push_back(suggestion.best->reasons);
      continue;
    }
    MissingPath missing{suggestion.side == "left", suggestion.rejection};
    missing.smallest = read_screws(screws.empty() ? data_file("screws/pedicle.json") : screws).front();
    head.missing.push_back(missing);
  }
  return grade_report(head, progress);
}

void write_planning_report(const GradeReportData& head, const std::vector<Suggestion>& suggestions,
                           const std::vector<GradedPath>& graded, const std::filesystem::path& screws,
                           const std::filesystem::path& file, const Progress& progress) {
  StagedOutput output;
  output.write(file, planning_report(head, suggestions, graded, screws, progress));
  output.commit();
  print_figure("report", file.string());
}

void add_plan(CLI::App& program, Command& command) {
  struct Options {
    std::filesystem::path bone;
    Level level = Level::kNone;
    std::vector<std::string> levels;
    std::filesystem::path output = "plan.json";
    std::string name = "path";
    PathOptions path;
    bool is_auto = false;
    AutoPlanOptions suggest;
    PlacementOptions placement;
    std::filesystem::path report;
    PageOptions page;
    PlanCheckOptions check;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app = add_command(
      program, command, "plan", "Write a plan: from given points, or with a screw suggested for each side",
      "Examples: spinaltap plan bone.vdb --auto -o plan.json --report plan.html\n"
      "          spinaltap plan spine.vdb --level L3 --auto --ct ct/ --report l3.html\n"
      "          spinaltap plan spine.vdb --auto --levels T9,T10,T11 --ct ct/ -o plans/\n"
      "          spinaltap plan bone.vdb --auto --margin 1.5 -o plan.mrk.json\n"
      "          spinaltap plan bone.vdb --entry 18,42,3 --target 9,-6,5 -o plan.json\n"
      "          spinaltap plan bone.vdb --entry 0,50,0 --target 0,20,0 --shape plate --width 12 --thickness 0.8\n"
      "A name that ends in .mrk.json makes the plan lines for 3D Slicer.");
  app->add_option("bone", options->bone, "bone.vdb or spine.vdb")->required()->type_name("FILE");
  CLI::Option* level = add_level(*app, options->level);
  app->add_option(
         "--levels", options->levels,
         "Plan these levels of a spine.vdb, or all, with heads in line for a rod; -o is then a folder, for a plan "
         "and a report of each and rods.json")
      ->delimiter(',')
      ->type_name("LEVEL,..")
      ->excludes(level);
  app->add_option("-o,--output", options->output, "The plan to write")->capture_default_str()->type_name("FILE");
  app->add_option("--name", options->name, "Name of the given path")->capture_default_str();
  app->add_flag("--auto", options->is_auto, "Find the pedicles and suggest a path and a screw through each")
      ->excludes("--name");
  options->path.add_to(*app);
  add_auto_plan(*app, options->suggest);
  options->placement.add_to(*app);
  app->add_option("--report", options->report, "Also write a page with slices, plots, grades and safe zones")
      ->type_name("FILE");
  options->page.add_to(*app);
  options->check.add_other_ct(*app);
  options->check.add_from_front(*app);
  options->check.add_accept_warnings(*app);
  app->get_option("--auto")->excludes("--entry");
  for (const char* name : {"--screws", "--rules", "--margin", "--bicortical", "--sagittal", "--technique", "--errors",
                           "--registration", "--report", "--levels"}) {
    app->get_option(name)->needs("--auto");
  }
  app->get_option("--report")->excludes("--levels");

  command.run = [options, &command](const Progress& progress) {
    Json figures = Json::object();
    if (!options->levels.empty()) {
      options->suggest.bit = options->path.bit();
      return plan_levels({options->bone, options->levels, options->output, options->suggest, options->placement,
                          options->page, options->check},
                         command.exit_code, progress);
    }
    if (options->report.empty() && !(options->page.ct.folder.empty() && options->page.title.empty())) {
      fail("--ct and --title are for a report: expected --report or --levels too");
    }
    const Bone bone = Bone::load(options->bone, options->level);
    std::vector<DrillPath> paths;
    PlanFindings findings;
    if (std::optional<DrillPath> path = options->path.given_path(options->name)) {
      check_path_meets_bone(*path, bone.model());
      path->bone = bone.identity();
      paths = {*path};
      findings = check_plan(bone, paths, options->check);
    } else if (options->is_auto) {
      options->suggest.bit = options->path.bit();
      const PlacementModel model = options->placement.model();
      check_registration(model, bone, options->check, findings);
      const std::vector<Suggestion> suggestions = bone.suggest(options->suggest, progress);
      std::vector<GradedPath> graded = graded_paths(suggestions);
      add_uncertainty(bone, model, graded, progress);
      figures = report_suggestions(bone, suggestions, graded);
      if (!options->report.empty()) {
        CtVolume kept;
        const std::optional<CtVolume> ct = options->page.read({&bone, 1}, progress);
        GradeReportData head =
            report_head(options->page.title_of(bone, "Suggested paths"), options->page.command, bone, ct, kept);
        head.notes = findings.lines();
        write_planning_report(head, suggestions, graded, options->suggest.screws, options->report, progress);
      }
      if (graded.empty()) {  // all is written that there is
        report_bone_warnings(bone.model(), figures);
        command.exit_code = kAnswerIsNo;
        return figures;
      }
      paths = paths_of(suggestions);
    } else {
      fail("expected --entry and --target, or --auto");
    }
    write_plan(paths, options->output);
    figures.update(report_paths(paths));
    report_bone_warnings(bone.model(), figures);
    add_findings(bone, findings, figures);
    command.exit_code = say_findings(findings, options->check.accepts_warnings);
    print_figure("written", options->output.string());
    return figures;
  };
}

}  // namespace spinaltap
