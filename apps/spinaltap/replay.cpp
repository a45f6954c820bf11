#include <memory>
#include <string>
#include <vector>

#include "apps/spinaltap/command.h"
#include "apps/spinaltap/further_bones.h"
#include "apps/spinaltap/level_output.h"
#include "apps/spinaltap/plan_check.h"
#include "core/files/recorded_setup.h"
#include "vdb/sim/replay.h"

namespace spinaltap {
namespace {

struct ReplayOptions {
  std::filesystem::path record, bone;
  Level level = Level::kNone;
  std::vector<std::string> also;
  std::optional<EngineKind> engine;
  PlanCheckOptions check;
};

Json replay(const ReplayOptions& options, const Progress& progress, int& exit_code) {
  const SessionRecord record = read_record(options.record);
  const std::string hash = hash_of(record);
  const std::vector<Bone> bones = load_bones(options.bone, options.level, options.also);
  const SessionSetup setup = recorded_setup(record.setup, options.record);
  std::vector<std::string> notes;
  options.check.check_same("record " + options.record.filename().string(), setup.bone, bones.front().identity(), notes);
  for (const std::string& note : notes) print_figure("note", note);
  const Replay result =
      spinaltap::replay(record, options.record, bones, options.engine, progress, options.check.takes_other_ct);
  exit_code = result.is_same() ? kDone : kAnswerIsNo;
  const bool is_other = setup.bone_hash != bones.front().hash();
  if (is_other) print_figure("note", "another bone than the one that was drilled, as --other-ct says");
  print_figure("record", record.is_whole ? "whole" : "cut short");
  print_figure("its hash", hash);
  print_figure("cycles compared", static_cast<double>(result.cycles), "", 0);
  print_figure("events compared", static_cast<double>(result.events), "", 0);
  if (!result.gap.empty()) print_figure("gap", result.gap);
  print_figure("first difference", result.difference.empty() ? "none" : result.difference);
  return {{"same", result.is_same()},    {"record_hash", hash},
          {"is_whole", record.is_whole}, {"cycles", result.cycles},
          {"events", result.events},     {"recorded", record.cycles.size()},
          {"lost", record.lost},         {"difference", result.difference},
          {"gap", result.gap},           {"seconds", result.seconds},
          {"other_bone", is_other}};
}

}  // namespace

void add_replay(CLI::App& program, Command& command) {
  const auto options = std::make_shared<ReplayOptions>();
  CLI::App* app = add_command(program, command, "replay", "Run a recorded drilling again and compare every bit",
                              "Example: spinaltap replay session.h5 bone.vdb --engine reference --threads 1\n"
                              "Records that were cut short are compared as far as they go. The exit code is 0 where\n"
                              "every number comes out the same, 1 where one differs or cycles are missing, 2 where\n"
                              "the record cannot be run.");
  app->add_option("record", options->record, "A record of drill --record")->required()->type_name("RECORD");
  app->add_option("bone", options->bone, "The bone.vdb or spine.vdb that was drilled")->required()->type_name("BONE");
  add_level(*app, options->level);
  add_also(*app, options->also);
  app->add_option("--engine", options->engine,
                  "Drilling engine: ring, leaf, arc, reference (default, and auto: that of the record); same result")
      ->transform(one_of(engine_kinds()))
      ->type_name("NAME");
  options->check.add_other_ct(*app);
  command.run = [options, &command](const Progress& progress) { return replay(*options, progress, command.exit_code); };
}

}  // namespace spinaltap
