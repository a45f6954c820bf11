#include "apps/spinaltap/cluster/slurm_script.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>

#include "apps/spinaltap/cluster/run_process.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

/// A line of a script is one line, whatever the option holds.
const std::string& checked(const std::string& text) {
  if (std::any_of(text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c) != 0; })) {
    fail("expected names and options of Slurm on one line, found one with control characters");
  }
  return text;
}

std::string directive(const std::string& option, const std::string& value) {
  return value.empty() ? "" : "#SBATCH --" + option + "=" + checked(value) + "\n";
}

/// A job's name holds no spaces and nothing that Slurm reads as a pattern.
std::string job_name(const std::string& study) {
  std::string name = "spinaltap-" + study;
  std::replace_if(
      name.begin(), name.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '_' && c != '.'; }, '_');
  return name;
}

std::string variable(const std::string& name, const std::filesystem::path& value) {
  return name + "=" + shell_words({checked(value.string())}) + "\n";
}

std::string common_directives(const SlurmOptions& options) {
  std::string text = directive("partition", options.partition) + directive("account", options.account);
  for (const std::string& extra : options.extras) {
    if (!extra.starts_with("-")) fail("expected options of sbatch like --constraint=avx2, found \"", extra, "\"");
    text += "#SBATCH " + checked(extra) + "\n";
  }
  return text;
}

}  // namespace

std::string slurm_ranges(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (std::size_t n = 0; n < numbers.size();) {
    std::size_t end = n + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
    text += (text.empty() ? "" : ",") + std::to_string(numbers[n]);
    if (end > n + 1) text += "-" + std::to_string(numbers[end - 1]);
    n = end;
  }
  return text;
}

std::string slurm_time(double seconds) {
  const auto minutes = static_cast<long>(std::ceil(seconds / 60.0));
  char text[64];
  if (minutes >= 24 * 60) {
    std::snprintf(text, sizeof text, "%ld-%02ld:%02ld:00", minutes / (24 * 60), minutes / 60 % 24, minutes % 60);
  } else {
    std::snprintf(text, sizeof text, "%02ld:%02ld:00", minutes / 60, minutes % 60);
  }
  return text;
}

std::string array_script(const SlurmStudy& study) {
  const SlurmOptions& options = study.options;
  const std::string at_once = options.at_once > 0 ? "%" + std::to_string(options.at_once) : "";
  return "#!/bin/bash\n"
         "# A study in shards, a task each, as spinaltap study submit wrote it. By hand, in the study's folder:\n"
         "#   sbatch study.sbatch; sbatch --array=3,7 study.sbatch; then spinaltap merge . or sbatch merge.sbatch\n"
         "# It may be killed, preempted, requeued and submitted again at any moment: finished runs stand in "
         "part-*.csv,\n"
         "# and a task does those of its shard that do not.\n"
         "#SBATCH --job-name=" +
         job_name(study.name) +
         "\n"
         "#SBATCH --array=1-" +
         std::to_string(study.shards) + at_once +
         "\n"
         "#SBATCH --output=" +
         kSlurmLogs +
         "/shard-%a.log\n"
         "#SBATCH --open-mode=append\n"
         "#SBATCH --nodes=1\n"
         "#SBATCH --ntasks=1\n"
         "#SBATCH --cpus-per-task=" +
         std::to_string(options.cpus) + "\n" + directive("mem", options.mem) + directive("time", options.time) +
         "#SBATCH --requeue\n"
         "# Two minutes before the time is up this script is told, and hands it on: the runs under way are finished.\n"
         "#SBATCH --signal=B:USR1@120\n" +
         common_directives(options) + "\n" + variable("program", study.program) + variable("spec", study.spec) +
         variable("folder", study.folder) + "shards=" + std::to_string(study.shards) +
         "\n"
         "\n"
         "signalled= leaves= time_is_up= child=\n"
         "hand_on() { signalled=yes; [ -z \"$child\" ] || kill -\"$1\" \"$child\" 2>/dev/null; }\n"
         "trap 'time_is_up=yes; hand_on USR1' USR1  # above\n"
         "trap 'leaves=yes; hand_on TERM' TERM      # preempted, requeued or cancelled: Slurm does what comes after\n"
         "\n"
         "echo \"$(date +%FT%T) shard $SLURM_ARRAY_TASK_ID of $shards on $(hostname), start "
         "$((${SLURM_RESTART_COUNT:-0} + 1))\"\n"
         "rows() { cat \"$folder/part-$SLURM_ARRAY_TASK_ID-of-$shards.\"* 2>/dev/null | wc -l; }\n"
         "rows_before=$(rows)\n"
         "# What killed it, but the signals above, was a want of memory or a hand: it goes on where it was, twice.\n"
         "for attempt in 1 2 3; do\n"
         "  \"$program\" study \"$spec\" -o \"$folder\" --shard \"$SLURM_ARRAY_TASK_ID/$shards\" \\\n"
         "    --threads \"${SLURM_CPUS_PER_TASK:-" +
         std::to_string(options.cpus) +
         "}\" &\n"
         "  child=$!\n"
         "  [ -z \"$leaves$time_is_up\" ] || kill -TERM \"$child\"\n"
         "  # A signal ends wait and not the program.\n"
         "  while :; do signalled=; wait \"$child\"; code=$?; [ -n \"$signalled\" ] || break; done\n"
         "  [ \"$code\" -gt 128 ] && [ -z \"$leaves$time_is_up\" ] || break\n"
         "  echo \"$(date +%FT%T) ended with $code\"\n"
         "done\n"
         "if [ \"$code\" -ne 0 ] && [ -n \"$time_is_up\" ]; then\n"
         "  if [ \"$(rows)\" -gt \"$rows_before\" ]; then\n"
         "    echo \"$(date +%FT%T) the time is up, with runs left: queues again\"\n"
         "    scontrol requeue \"$SLURM_JOB_ID\"\n"
         "  else\n"
         "    echo \"$(date +%FT%T) the time is up, and no run was finished in it: expected a longer --time\"\n"
         "  fi\n"
         "fi\n"
         "exit \"$code\"\n";
}

std::string merge_script(const SlurmStudy& study) {
  return "#!/bin/bash\n"
         "# Joins the shards of a study, when all are done: runs.csv, summary.json, breach_map.csv and report.html. "
         "As\n"
         "# spinaltap study submit wrote it, which lets it wait for the array (--dependency=afterok:...).\n"
         "#SBATCH --job-name=" +
         job_name(study.name) +
         "-merge\n"
         "#SBATCH --output=" +
         kSlurmLogs +
         "/merge.log\n"
         "#SBATCH --open-mode=append\n"
         "#SBATCH --nodes=1\n"
         "#SBATCH --ntasks=1\n"
         "#SBATCH --time=00:30:00\n"
         "#SBATCH --requeue\n" +
         common_directives(study.options) + "\n" + variable("program", study.program) +
         variable("folder", study.folder) + "exec \"$program\" merge \"$folder\" --force\n";
}

std::vector<std::string> submit_array(const SlurmStudy& study, const std::vector<std::size_t>& shards) {
  std::vector<std::string> words{"sbatch", "--parsable", "--chdir=" + study.folder.string()};
  if (!shards.empty()) {
    const int at_once = study.options.at_once;
    words.push_back("--array=" + slurm_ranges(shards) + (at_once > 0 ? "%" + std::to_string(at_once) : ""));
  }
  words.push_back((study.folder / kArrayScript).string());
  return words;
}

std::vector<std::string> submit_merge(const SlurmStudy& study, const std::vector<std::string>& after) {
  std::vector<std::string> words{"sbatch", "--parsable", "--chdir=" + study.folder.string()};
  if (!after.empty()) {
    std::string jobs;
    for (const std::string& job : after) jobs += ":" + job;
    words.push_back("--dependency=afterok" + jobs);
    words.push_back("--kill-on-invalid-dep=yes");
  }
  words.push_back((study.folder / kMergeScript).string());
  return words;
}

}  // namespace spinaltap
