#include <charconv>
#include <memory>
#include <optional>
#include <utility>

#include "apps/report/study_inputs.h"
#include "apps/report/study_results.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/study_output.h"
#include "core/base/error.h"
#include "core/files/study_identity.h"
#include "core/files/study_spec_file.h"
#include "core/files/study_summary_json.h"
#include "vdb/grid/bone_model.h"
#include "vdb/sim/study_run.h"

namespace spinaltap {
namespace {

/// One of the shares that a study is cut into: every run whose number modulo `count` is `index` - 1.
struct Shard {
  std::size_t index = 1;
  std::size_t count = 1;
};

Shard read_shard(const std::string& text) {
  constexpr std::size_t kMost = 100'000;
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto [slash, first] = std::from_chars(text.data(), end, shard.index);
  const bool has_slash = first == std::errc{} && slash != end && *slash == '/';
  const auto [stop, second] = std::from_chars(has_slash ? slash + 1 : end, end, shard.count);
  if (!has_slash || second != std::errc{} || stop != end || shard.index < 1 || shard.index > shard.count ||
      shard.count > kMost) {
    fail("expected a shard like 1/4, the first of four, found \"", text, "\"");
  }
  return shard;
}

struct StudyCommandOptions {
  std::filesystem::path spec;
  std::string shard = "1/1";
  std::filesystem::path folder = "study";
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

Json study(const StudyCommandOptions& options, const Progress& progress) {
  const Shard shard = read_shard(options.shard);
  StudySpec spec = read_study_spec(options.spec);
  const StudyRuns runs(spec.design);
  spec.volume.radius_mm = study_radius_mm(spec, runs);
  const SessionBone bone(read_bone(spec.bone_file, spec.level), true, progress);
  const StudyIdentity identity = study_identity(spec, runs, hash_of(bone.model()));
  open_study_folder(options.folder, identity);

  std::vector<std::size_t> left;
  {
    StudyRows rows;
    read_study_parts(options.folder, identity, rows);
    for (std::size_t n = shard.index - 1; n < runs.count(); n += shard.count) {
      if (!rows.contains(n)) left.push_back(n);
    }
  }
  Json figures{{"left", left.size()}};
  if (!left.empty()) {
    StudyPart part(options.folder,
                   "part-" + std::to_string(shard.index) + "-of-" + std::to_string(shard.count) + ".csv", identity);
    const StudyBench bench(bone, spec, runs, progress);
    const StudyWork work = do_study_runs(
        left, [&bench] { return bench.make_runner(); }, [&part](const StudyRow& row) { part.append(study_csv(row)); },
        progress);
    figures["work"] = figures_of(work);
    figures["points"] = bench.volume().point_count();
    figures["megabytes_a_thread"] = static_cast<double>(bench.volume().memory_bytes()) / 1e6;
    print_figure("runs done now", static_cast<double>(work.runs), "", 0);
    print_figure("threads", work.threads, "", 0);
    print_figure("rate", static_cast<double>(work.runs) / work.seconds, "runs/s");
    print_figure("processor time a run", 1e3 * work.cpu_seconds / static_cast<double>(work.runs), "ms");
  }
  if (!bone.remark().empty()) print_figure("no canal, no landmarks", bone.remark());
  StudyRows rows;
  read_study_parts(options.folder, identity, rows);
  if (rows.size() == runs.count()) {
    const StudySummary summary = write_study_results(options.folder, identity, rows);
    figures["summary"] = to_json(summary);
    print_study(summary, options.folder);
  } else {
    print_figure("runs of the study there are", std::to_string(rows.size()) + " of " + std::to_string(runs.count()));
    print_figure("when all shards are done", "spinaltap merge FOLDER... -o FOLDER");
  }
  return figures;
}

}  // namespace

void add_study(CLI::App& program, Command& command) {
  const auto options = std::make_shared<StudyCommandOptions>();
  CLI::App* app = add_command(program, command, "study",
                              "Drill one path many times, with errors, on all cores; writes runs.csv, summary.json and "
                              "report.html. Started again it goes on where it was",
                              "Example: spinaltap study study.json -o study/ --shard 1/4");
  app->add_option("spec", options->spec, "What to study: docs/studies.md")->required()->type_name("SPEC.json");
  app->add_option("-o,--output", options->folder, "Folder for the results, and for those so far")
      ->capture_default_str()
      ->type_name("FOLDER");
  app->add_option("--shard", options->shard, "Only the i-th of n shares of the runs; merge joins them")
      ->capture_default_str()
      ->type_name("I/N");
  command.run = [options](const Progress& progress) { return study(*options, progress); };
}

}  // namespace spinaltap
