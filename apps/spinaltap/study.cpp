#include <malloc.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include "apps/report/study_report.h"
#include "apps/spinaltap/cluster/study_commands.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/plan_check.h"
#include "apps/spinaltap/study_output.h"
#include "apps/spinaltap/terminal_progress.h"
#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/ct/bone_identity.h"
#include "core/files/study_spec_file.h"
#include "core/files/study_summary_json.h"
#include "vdb/sim/study.h"

namespace spinaltap {
namespace {

StudyShard read_shard(const std::string& text) {
  constexpr std::size_t kMax = 100'000;
  StudyShard shard;
  const char* const end = text.data() + text.size();
  const auto [slash, first] = std::from_chars(text.data(), end, shard.index);
  const bool has_slash = first == std::errc{} && slash != end && *slash == '/';
  const auto [stop, second] = std::from_chars(has_slash ? slash + 1 : end, end, shard.count);
  if (!has_slash || second != std::errc{} || stop != end || shard.index < 1 || shard.index > shard.count ||
      shard.count > kMax) {
    fail("expected a shard like 1/4, the first of four, found \"", text, "\"");
  }
  return shard;
}

struct StudyCommandOptions {
  std::filesystem::path spec;
  std::string shard = "1/1";
  std::filesystem::path folder = "study";
  PlanCheckOptions check;
};

Json figures_of(const StudyWork& work) {
  const double runs = static_cast<double>(work.runs);
  return {{"runs", work.runs},
          {"threads", work.threads},
          {"seconds", work.seconds},
          {"cpu_seconds", work.cpu_seconds},
          {"runs_per_s", work.runs > 0 ? runs / work.seconds : 0.0},
          {"cpu_seconds_per_run", work.runs > 0 ? work.cpu_seconds / runs : 0.0}};
}

/// What speaks against the plans and speeds of a study, whose bones were looked at when it was made.
PlanFindings findings_of(const StudySpec& spec) {
  PlanFindings findings;
  const auto is_nameless = [](const DrillPath& path) { return !path.bone.names_ct(); };
  for (const StudyBone& bone : spec.bones) {
    findings.warnings.insert(findings.warnings.end(), bone.faults.begin(), bone.faults.end());
    if (spec.takes_other_ct) {
      for (const DrillPath& path : bone.paths) {
        if (may_be_same(path.bone, bone.identity)) continue;
        findings.notes.push_back("plan, path " + in_quotes(path.name) + ", is of " + words_of(path.bone) +
                                 ", the bone is " + words_of(bone.identity) + ": taken all the same");
      }
    }
  }
  if (std::ranges::any_of(spec.bones,
                          [&](const StudyBone& bone) { return std::ranges::any_of(bone.paths, is_nameless); })) {
    findings.notes.emplace_back("a plan does not name its CT: nothing tells whether it was made for its bone");
  }
  if (spec.registration && !spec.registration->bone.names_ct()) {
    findings.notes.emplace_back("the study's registration does not name its CT");
  }
  const std::vector<std::string> speeds = speed_warnings(spec);
  findings.warnings.insert(findings.warnings.end(), speeds.begin(), speeds.end());
  return findings;
}

Json run_study(const StudyCommandOptions& options, Command& command, const Progress& progress) {
  const StudyShard shard = read_shard(options.shard);
  leave_on_signals();
  StudySpec spec = read_study_spec(options.spec);
  spec.takes_other_ct = spec.takes_other_ct || options.check.takes_other_ct;
  spec.from_the_front = spec.from_the_front || options.check.from_the_front;
  std::optional<Study> loaded(Study(std::move(spec), progress, options.folder));
  const Study& study = *loaded;
  const PlanFindings findings = findings_of(study.spec());
  const StudyWork work = study.run_into(options.folder, shard, progress, [] { return leave_signal() != nullptr; });
  Json figures{{"left", work.runs}};
  if (work.runs > 0) {
    figures["work"] = figures_of(work);
    if (study.points() > 0) {
      figures["points"] = study.points();
      figures["megabytes_a_thread"] = static_cast<double>(study.bytes_a_thread()) / 1e6;
    }
    print_figure("runs done now", static_cast<double>(work.runs), "", 0);
    print_figure("threads", work.threads, "", 0);
    print_figure("rate", static_cast<double>(work.runs) / work.seconds, "runs/s");
    print_figure("processor time a run", 1e3 * work.cpu_seconds / static_cast<double>(work.runs), "ms");
  }
  if (!work.unlocked_part.empty()) {
    print_figure("no locks on this file system", "rows of this process: " + work.unlocked_part.filename().string());
  }
  if (work.is_stopped) {
    const ShardProgress so_far = merge({&options.folder, 1}).progress_of(shard);
    std::fprintf(stderr,
                 "spinaltap: told to leave by %s: %zu of %zu runs of shard %zu/%zu are done and kept, the same "
                 "command goes on with the others\n",
                 leave_signal(), so_far.done, so_far.runs, shard.index, shard.count);
    figures["left_by"] = leave_signal();
    command.exit_code = kLeftUnfinished;
    return figures;
  }
  if (study.spec().bones.size() == 1) {
    const std::string no_landmarks = study.bone().no_landmarks(progress);
    if (!no_landmarks.empty()) print_figure("no canal, no landmarks", no_landmarks);
  }
  figures["plan_notes"] = findings.notes;
  figures["plan_warnings"] = findings.warnings;
  const int code = say_findings(findings, options.check.accepts_warnings);
  if (shard.count == 1) command.exit_code = code;  // a job of a cluster has not failed
  loaded.reset();
  ::malloc_trim(0);  // the rows take the bone's room
  const StudyTable table = merge({&options.folder, 1});
  if (table.is_whole()) {
    const StudySummary summary = write_study_results(options.folder, table.identity, table.rows);
    figures["summary"] = to_json(summary);
    print_study(summary, options.folder);
  } else {
    print_figure("runs of the study there are",
                 std::to_string(table.rows.size()) + " of " + std::to_string(table.identity.runs));
    print_figure("when all shards are done", "spinaltap merge FOLDER... -o FOLDER");
  }
  return figures;
}

}  // namespace

void add_study(CLI::App& program, Command& command) {
  const auto options = std::make_shared<StudyCommandOptions>();
  CLI::App* app = add_command(program, command, "study",
                              "Drill one path many times, with errors, on all cores; writes runs.csv, summary.json, "
                              "breach_map.csv and report.html. Started again it goes on where it was",
                              "Example: spinaltap study study.json -o study/ --shard 1/4");
  app->add_option("spec", options->spec, "What to study: docs/studies.md")->type_name("SPEC.json");
  app->add_option("-o,--output", options->folder, "Folder for the results, and for those so far")
      ->capture_default_str()
      ->type_name("FOLDER");
  app->add_option("--shard", options->shard, "Only the i-th of n shares of the runs; merge joins them")
      ->capture_default_str()
      ->type_name("I/N");
  options->check.add_other_ct(*app);
  options->check.add_from_front(*app);
  options->check.add_accept_warnings(*app);
  app->require_subcommand(0, 1);
  app->parse_complete_callback([app, options] {
    if (app->get_subcommands().empty() && options->spec.empty()) throw CLI::RequiredError("spec");
  });
  command.after_stop = "the runs that are done are kept; the same command goes on";
  command.run = [options, &command](const Progress& progress) { return run_study(*options, command, progress); };
}

}  // namespace spinaltap
