#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/spinaltap/command.h"
#include "apps/spinaltap/drill_options.h"
#include "apps/spinaltap/drill_run.h"
#include "apps/spinaltap/further_bones.h"
#include "apps/spinaltap/level_output.h"
#include "apps/spinaltap/plan_check.h"
#include "apps/spinaltap/report_options.h"
#include "apps/spinaltap/stage_times.h"
#include "core/base/error.h"
#include "core/files/plan_file.h"
#include "core/session/cycle.h"
#include "core/tool/tool_speed.h"

namespace spinaltap {
namespace {

/// Throws Error where the path does not fit the bone, unless it is forced.
PlanFindings findings_of(const Bone& bone, const DrillPath& path, const DrillOptions& drill,
                         const PlanCheckOptions& check) {
  const double tolerance_mm = drill.tool_operator.is_milling() ? kMillingToleranceMm : PathCheckOptions().tolerance_mm;
  PlanFindings findings = check_plan(bone, {&path, 1}, check, tolerance_mm);
  if (!findings.warnings.empty() && !check.forces_path) {
    fail(findings.warnings.front(), "; put the plan right, or --force-path to drill it all the same");
  }
  return findings;
}

}  // namespace

void add_drill(CLI::App& program, Command& command) {
  struct Options {
    std::filesystem::path bone;
    Level level = Level::kNone;
    std::vector<std::string> also;
    std::filesystem::path plan;
    std::string path_name;
    std::filesystem::path folder = "drilled";
    PageOptions page;
    DrillOptions drill;
    PlanCheckOptions check;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app = add_command(
      program, command, "drill",
      "Drill a planned path; writes report.html, drilled.vdb, drilled.stl, log.csv and events.csv",
      "Examples: spinaltap drill bone.vdb plan.json --ct ct/ -o drilled/\n"
      "          spinaltap drill bone.vdb plan.json --operator push --push 40 --stop-on-breach\n"
      "          spinaltap drill bone.vdb plan.json --operator tremor --real-time --record run.h5\n"
      "          spinaltap drill spine.vdb --level L4 --additional-bone spine.vdb:L5 plan.json --operator mill.json");
  app->add_option("bone", options->bone, "bone.vdb or spine.vdb")->required()->type_name("FILE");
  add_level(*app, options->level);
  add_also(*app, options->also);
  app->add_option("plan", options->plan, "plan.json")->required()->type_name("FILE");
  app->add_option("--path", options->path_name, "Name of the path in the plan; default: the first")->type_name("NAME");
  app->add_option("-o,--output", options->folder, "Folder for the results")->capture_default_str()->type_name("FOLDER");
  options->page.add_to(*app);
  options->drill.add_to(*app);
  options->drill.add_session_to(*app);
  options->check.add_other_ct(*app);
  options->check.add_from_front(*app);
  options->check.add_force_path(*app);
  options->check.add_accept_warnings(*app);

  command.after_stop = "nothing was written but the cycles of a --record; the same command begins again";
  command.outputs = [options] { return std::vector{options->drill.record}; };
  command.run = [options, &command](const Progress& progress) {
    StageClock clock;
    options->drill.bones = 1 + options->also.size();
    options->drill.may_replace_record = command.is_forced;
    const std::vector<DrillPath> paths = read_plan(options->plan);
    const DrillPath& path = choose_path(paths, options->path_name);
    options->drill.check(path.bit);  // before anything large is read
    const std::vector<Bone> bones = load_bones(options->bone, options->level, options->also);
    const Bone& bone = bones.front();
    PlanFindings findings = findings_of(bone, path, options->drill, options->check);
    const bool is_forced = !findings.warnings.empty();
    const std::vector<std::string> speeds = speed_warnings(path.bit, options->drill.tool_operator.asked_feeds_mm_s(),
                                                           options->drill.setup.options.spindle.rpm);
    findings.warnings.insert(findings.warnings.end(), speeds.begin(), speeds.end());
    options->drill.setup.takes_other_ct = options->check.takes_other_ct;
    const std::optional<CtVolume> ct = options->page.read({&bone, 1}, progress);
    clock.end("read");
    StagedOutput output;
    Json figures = run_drill({options->page.title_of(bone, "Drilling " + path.name), options->page.command,
                              ct ? &*ct : nullptr, findings.lines()},
                             bones, path, options->drill, options->folder, output, clock, progress);
    add_findings(bone, findings, figures);
    command.exit_code = say_findings(findings, options->check.accepts_warnings || (is_forced && speeds.empty()));
    const auto is_breach = [](const Json& event) { return event["event"] == name_of(EventKind::stop_breach); };
    if (std::any_of(figures["events"].begin(), figures["events"].end(), is_breach) ||
        figures["operator_end"] != name_of(OperatorEnd::as_planned)) {
      command.exit_code = kAnswerIsNo;
    }
    figures["times"] = report_times(clock);
    return figures;
  };
}

}  // namespace spinaltap
