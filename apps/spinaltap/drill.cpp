#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/spinaltap/command.h"
#include "apps/spinaltap/drill_options.h"
#include "apps/spinaltap/drill_run.h"
#include "apps/spinaltap/further_bones.h"
#include "apps/spinaltap/level_output.h"
#include "apps/spinaltap/report_options.h"
#include "apps/spinaltap/stage_times.h"
#include "core/files/plan_file.h"
#include "core/session/session_event.h"

namespace spinaltap {

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
  };
  const auto options = std::make_shared<Options>();
  CLI::App* app =
      add_command(program, command, "drill",
                  "Drill a planned path; writes report.html, drilled.vdb, drilled.stl, log.csv and events.csv",
                  "Examples: spinaltap drill bone.vdb plan.json --ct ct/ -o drilled/\n"
                  "          spinaltap drill bone.vdb plan.json --operator push --push 40 --stop-on-breach\n"
                  "          spinaltap drill bone.vdb plan.json --operator tremor --real-time --record run.h5\n"
                  "          spinaltap drill spine.vdb --level L4 --also spine.vdb:L5 plan.json --operator mill.json");
  app->add_option("bone", options->bone, "bone.vdb or spine.vdb")->required()->type_name("FILE");
  add_level(*app, options->level);
  add_also(*app, options->also);
  app->add_option("plan", options->plan, "plan.json")->required()->type_name("FILE");
  app->add_option("--path", options->path_name, "Name of the path in the plan; default: the first")->type_name("NAME");
  app->add_option("-o,--output", options->folder, "Folder for the results")->capture_default_str()->type_name("FOLDER");
  options->page.add_to(*app);
  options->drill.add_to(*app);
  options->drill.add_session_to(*app);

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
    const std::optional<CtVolume> ct = options->page.read({&bone, 1}, progress);
    clock.end("read");
    StagedOutput output;
    Json figures =
        run_drill({options->page.title_of(bone, "Drilling " + path.name), options->page.command, ct ? &*ct : nullptr},
                  bones, path, options->drill, options->folder, output, clock, progress);
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
