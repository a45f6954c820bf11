#include <sys/resource.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <optional>

#include "apps/spinaltap/cluster/run_process.h"
#include "apps/spinaltap/cluster/study_commands.h"
#include "apps/spinaltap/cluster/study_jobs.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/text_writer.h"
#include "core/files/study_folder.h"
#include "core/study/study_shard.h"
#include "vdb/sim/study.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

/// Shorter tasks cost the queue and the start more than they bring.
constexpr double kMinTaskSeconds = 1800.0;
/// Slurm's MaxArraySize where nobody changed it, less one.
constexpr std::size_t kMaxShards = 1000;

struct SubmitOptions {
  fs::path spec;
  fs::path folder = "study";
  std::size_t shards = 0;  ///< 0: from the rate
  double run_s = 0.0;      ///< processor time; 0: measured
  bool is_dry = false;
  SlurmOptions slurm;
};

/// What a run takes.
struct MeasuredRuns {
  std::size_t runs = 0;
  double cpu_s_a_run = 0.0;
  double max_memory_mb = 0.0;
};

/// Does a few runs as a task will. They stay in the folder and count.
MeasuredRuns measure(const Study& study, const fs::path& folder, int threads, const Progress& progress) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  const std::size_t wanted = 2 * static_cast<std::size_t>(threads);
  const StudyWork work = study.run_into(folder, {1, std::max<std::size_t>(study.run_count() / wanted, 1)}, progress);
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  if (work.runs == 0) fail("the runs that would be timed are done already: expected --run-seconds, or --shards");
  return {work.runs, work.cpu_seconds / static_cast<double>(work.runs), static_cast<double>(usage.ru_maxrss) / 1024.0};
}

/// A folder for what is timed only.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "spinaltap-timed-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
      fail_as(ErrorKind::disk, "cannot make a folder in ", fs::temp_directory_path().string());
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

fs::path absolute_path(const fs::path& path) {
  fs::path whole = fs::weakly_canonical(fs::absolute(path));
  return whole.has_filename() ? whole : whole.parent_path();
}

std::size_t shards_for(std::size_t runs, double run_s, int cpus) {
  const double all_s = static_cast<double>(runs) * run_s / cpus;
  return static_cast<std::size_t>(
      std::clamp(std::floor(all_s / kMinTaskSeconds), 1.0, static_cast<double>(std::min(runs, kMaxShards))));
}

void print_words(const char* what, const std::vector<std::string>& words) {
  std::printf("# %s\n%s\n\n", what, shell_words(words).c_str());
}

/// Submits shards, all where there are none named, and the merge after them; notes both.
SubmittedJobs submit(StudyJobs& jobs, const std::vector<std::size_t>& shards, std::vector<std::string> after,
                     std::size_t runs_done, bool has_shards) {
  const SlurmStudy& study = jobs.study;
  fs::create_directories(study.folder / kSlurmLogs);
  jobs.submitted.push_back({"", "", static_cast<std::int64_t>(std::time(nullptr)), runs_done});
  SubmittedJobs& one = jobs.submitted.back();
  if (has_shards) {
    one.array = submit_job(submit_array(study, shards));
    write_study_jobs(jobs);  // the array is known, whatever becomes of the merge
    after.insert(after.begin(), one.array);
  }
  one.merge = submit_job(submit_merge(study, after));
  write_study_jobs(jobs);
  return one;
}

/// The program as people type it (launcher.cpp), for scripts that they read.
fs::path typed_program() {
  const fs::path commands = fs::read_symlink("/proc/self/exe");
  const fs::path typed = commands.parent_path().parent_path() / "bin/spinaltap";
  std::error_code error;
  return fs::exists(typed, error) ? typed : commands;
}

Json run_submit(const SubmitOptions& options, const Progress& progress) {
  const Study study = Study::load(options.spec, progress, options.folder);
  const std::size_t runs = study.run_count();
  StudyJobs jobs;
  SlurmStudy& slurm = jobs.study;
  slurm.program = typed_program();
  slurm.spec = absolute_path(options.spec);
  slurm.folder = absolute_path(options.folder);
  slurm.name = study.spec().name;
  slurm.options = options.slurm;
  array_script(slurm);  // what makes no sense is told before runs are timed

  double run_s = options.run_s;
  std::optional<MeasuredRuns> measured;
  if (!(run_s > 0.0) && (options.shards == 0 || options.slurm.time.empty())) {
    std::optional<ScratchFolder> scratch;
    if (options.is_dry) scratch.emplace();
    measured = measure(study, scratch ? scratch->path() : slurm.folder, options.slurm.cpus, progress);
    run_s = measured->cpu_s_a_run;
  }
  slurm.shards = options.shards > 0 ? options.shards : shards_for(runs, run_s, options.slurm.cpus);
  if (slurm.shards > runs) fail("expected at most ", runs, " shards of as many runs, found ", slurm.shards);
  const double shard_runs = std::ceil(static_cast<double>(runs) / static_cast<double>(slurm.shards));
  const double shard_s = run_s * shard_runs / options.slurm.cpus;
  // Twice what it takes here, since others share its node, and ten minutes to begin with.
  if (slurm.options.time.empty()) slurm.options.time = slurm_time(2.0 * shard_s + 600.0);
  if (slurm.options.mem.empty() && measured) {
    constexpr double kStepMb = 256.0;
    slurm.options.mem = fixed_text(kStepMb * std::ceil(1.5 * measured->max_memory_mb / kStepMb), 0) + "M";
  }
  const std::string array = array_script(slurm), merge = merge_script(slurm);

  Json figures{{"runs", runs},
               {"shards", slurm.shards},
               {"cpus", options.slurm.cpus},
               {"time", slurm.options.time},
               {"mem", slurm.options.mem},
               {"is_dry", options.is_dry}};
  if (options.is_dry) {
    std::printf("# %s\n%s\n", (slurm.folder / kArrayScript).c_str(), array.c_str());
    std::printf("# %s\n%s\n", (slurm.folder / kMergeScript).c_str(), merge.c_str());
    print_words("gives the array's number", submit_array(slurm, {}));
    print_words("with that number", submit_merge(slurm, {"NUMBER"}));
  }
  print_figure("runs", static_cast<double>(runs), "", 0);
  print_figure("shards", static_cast<double>(slurm.shards), "", 0);
  if (run_s > 0.0) {
    figures["cpu_seconds_per_run"] = run_s;
    figures["seconds_a_shard"] = shard_s;
    print_figure(measured ? "processor time a run, measured" : "processor time a run, as given", run_s, "s", 3);
    print_figure("time a shard, expected", shard_s / 60.0, "min", 1);
  }
  print_figure("time limit of a task", slurm.options.time);
  if (!slurm.options.mem.empty()) print_figure("memory of a task", slurm.options.mem);
  if (options.is_dry) return figures;

  study.open_folder(slurm.folder);
  StagedOutput output;
  output.write(slurm.folder / kArrayScript, array);
  output.write(slurm.folder / kMergeScript, merge);
  output.commit();
  StudyRows done;
  read_study_parts(slurm.folder, study.identity(), done);
  const SubmittedJobs one = submit(jobs, {}, {}, done.size(), true);
  figures["array"] = one.array;
  figures["merge"] = one.merge;
  print_figure("array's job", one.array);
  print_figure("merge's job", one.merge);
  print_figure("how it goes", "spinaltap study status " + shell_words({options.folder.string()}));
  return figures;
}

struct ResumeOptions {
  fs::path folder;
  bool is_dry = false;
};

Json run_resume(const ResumeOptions& options) {
  StudyJobs jobs = read_study_jobs(options.folder);
  const SlurmStudy& slurm = jobs.study;
  const StudyTable table = merge({&options.folder, 1});
  const StudyQueue queue = ask_queue(jobs);
  std::vector<std::size_t> missing, queued;
  std::vector<std::string> after;
  for (std::size_t shard = 1; shard <= slurm.shards; ++shard) {
    if (table.progress_of({shard, slurm.shards}).is_done()) continue;
    if (queue.tasks.contains(shard)) {
      queued.push_back(shard);
      after.push_back(queue.names.at(shard));
    } else {
      missing.push_back(shard);
    }
  }
  Json figures{{"left", table.identity.runs - table.rows.size()},
               {"missing", missing},
               {"queued", queued},
               {"is_dry", options.is_dry}};
  print_figure("runs left", static_cast<double>(table.identity.runs - table.rows.size()), "", 0);
  print_figure("shards in the queue", queued.empty() ? "none" : slurm_ranges(queued));
  print_figure("shards to submit", missing.empty() ? "none" : slurm_ranges(missing));
  const bool has_results = table.is_whole() && fs::exists(options.folder / "runs.csv");
  if (missing.empty() && (has_results || !queue.merges.empty())) {
    print_figure("nothing to submit", has_results ? "all is done" : "what is left is in the queue");
    return figures;
  }
  if (options.is_dry) {
    if (!missing.empty()) print_words("gives the array's number", submit_array(slurm, missing));
    if (!missing.empty()) after.insert(after.begin(), "NUMBER");
    print_words(missing.empty() ? "joins what is done" : "with that number", submit_merge(slurm, after));
    return figures;
  }
  const SubmittedJobs one = submit(jobs, missing, after, table.rows.size(), !missing.empty());
  figures["array"] = one.array;
  figures["merge"] = one.merge;
  if (!one.array.empty()) print_figure("array's job", one.array);
  print_figure("merge's job", one.merge);
  return figures;
}

}  // namespace

void add_study_submit(CLI::App& program, Command& command) {
  const auto options = std::make_shared<SubmitOptions>();
  CLI::App* app = add_command(
      *program.get_subcommand("study"), command, "submit",
      "Hand a study to Slurm: an array with a task a shard, and a merge after it. Writes both scripts to the folder",
      "Example: spinaltap study submit study.json -o study/ --partition short --cpus 4 --dry-run");
  app->add_option("spec", options->spec, "What to study: docs/studies.md")->required()->type_name("SPEC.json");
  app->add_option("-o,--output", options->folder, "Folder for scripts, results and those so far; all nodes see it")
      ->capture_default_str()
      ->type_name("FOLDER");
  app->add_option("--shards", options->shards, "Tasks; default: as many as take half an hour each, or one")
      ->check(CLI::Range(1, 100'000))
      ->type_name("N");
  app->add_option("--run-seconds", options->run_s, "Processor time of a run, s; default: a few are timed, and count")
      ->check(CLI::Range(1e-6, 1e6))
      ->type_name("S");
  app->add_option("--cpus", options->slurm.cpus, "Processors of a task, and threads of its study")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str()
      ->type_name("N");
  app->add_option("--max-parallel-tasks", options->slurm.at_once,
                  "Tasks that run at the same time at most; default: no limit")
      ->check(CLI::Range(1, 100'000))
      ->type_name("N");
  app->add_option("--partition", options->slurm.partition, "Slurm's partition")->type_name("NAME");
  app->add_option("--account", options->slurm.account, "Slurm's account")->type_name("NAME");
  app->add_option("--time", options->slurm.time, "Time limit of a task; default: twice what is expected and 10 minutes")
      ->type_name("HH:MM:SS");
  app->add_option("--mem", options->slurm.mem, "Memory of a task; default: by half more than the timed runs took")
      ->type_name("SIZE");
  app->add_option("--sbatch", options->slurm.extras,
                  "A further option of sbatch, such as --sbatch=--constraint=avx2; may be repeated")
      ->type_name("OPTION");
  app->add_flag("--dry-run", options->is_dry, "Print the scripts and the commands; write and submit nothing");
  command.outputs = [options]() -> std::vector<fs::path> {
    if (options->is_dry) return {};
    return {jobs_file(options->folder)};
  };
  command.run = [options](const Progress& progress) { return run_submit(*options, progress); };
}

void add_study_resume(CLI::App& program, Command& command) {
  const auto options = std::make_shared<ResumeOptions>();
  CLI::App* app = add_command(*program.get_subcommand("study"), command, "resume",
                              "Submit again what of a study is neither done nor in Slurm's queue, and a merge after it",
                              "Example: spinaltap study resume study/ --dry-run");
  app->add_option("folder", options->folder, "Folder that study submit was given")->required()->type_name("FOLDER");
  app->add_flag("--dry-run", options->is_dry, "Print the commands; submit nothing");
  command.run = [options](const Progress&) { return run_resume(*options); };
}

}  // namespace spinaltap
