#include "apps/spinaltap/cluster/study_jobs.h"

#include <charconv>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/spinaltap/cluster/run_process.h"
#include "core/base/error.h"
#include "core/files/json_file.h"

namespace spinaltap {
namespace {

constexpr FileFormat kJobsFormat{"spinaltap-study-jobs", "list of a study's jobs", "submit the study again"};

std::string without_line_end(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text;
}

std::string first_line(const std::string& text) { return without_line_end(text.substr(0, text.find('\n'))); }

}  // namespace

std::filesystem::path jobs_file(const std::filesystem::path& folder) { return folder / "jobs.json"; }

StudyJobs read_study_jobs(const std::filesystem::path& folder) {
  const std::filesystem::path file = jobs_file(folder);
  if (!std::filesystem::exists(file)) {
    fail("expected a folder that spinaltap study submit made, with jobs.json, found ", folder.string());
  }
  const Json json = read_json(file);
  check_format(json, kJobsFormat, file);
  const JsonObject object(json, file);
  StudyJobs jobs;
  SlurmStudy& study = jobs.study;
  study.program = object.text("program");
  study.spec = object.text("spec");
  study.folder = object.text("folder");
  std::error_code error;
  if (!std::filesystem::equivalent(study.folder, folder, error)) {
    fail("the scripts in ", folder.string(), " are for ", study.folder.string(),
         ": submit the study again, with --force");
  }
  study.name = object.text("name");
  study.shards = object.whole_number("shards");
  if (study.shards < 1) fail("expected one shard or more in ", file.string(), ", found none");
  study.options.at_once = static_cast<int>(object.whole_number("at_once"));
  const Json& submitted = object.at("submitted");
  if (!submitted.is_array()) fail("expected a list \"submitted\" in ", file.string());
  for (const Json& item : submitted) {
    const JsonObject one(item, file);
    jobs.submitted.push_back({one.text("array"), one.text("merge"),
                              static_cast<std::int64_t>(one.whole_number("time_s")), one.whole_number("runs_done")});
  }
  return jobs;
}

void write_study_jobs(const StudyJobs& jobs) {
  Json json = format_head(kJobsFormat);
  const SlurmStudy& study = jobs.study;
  json.update(Json{{"program", study.program.string()},
                   {"spec", study.spec.string()},
                   {"folder", study.folder.string()},
                   {"name", study.name},
                   {"shards", study.shards},
                   {"at_once", study.options.at_once},
                   {"submitted", Json::array()}});
  for (const SubmittedJobs& one : jobs.submitted) {
    json["submitted"].push_back(
        {{"array", one.array}, {"merge", one.merge}, {"time_s", one.time_s}, {"runs_done", one.runs_done}});
  }
  write_json(json, jobs_file(study.folder));
}

std::string submit_job(const std::vector<std::string>& words) {
  const ProcessResult done = run_process(words);
  if (!done.is_found) fail("expected Slurm's sbatch on this computer, found none: --dry-run shows the scripts");
  if (done.exit_code != 0) fail("sbatch rejects the job: ", first_line(done.errors), " (", shell_words(words), ")");
  // "17", or "17;cluster"
  std::string job = first_line(done.output);
  job = job.substr(0, job.find(';'));
  if (job.empty() || job.find_first_not_of("0123456789") != std::string::npos) {
    fail("expected a job's number from sbatch, found \"", first_line(done.output), "\"");
  }
  return job;
}

StudyQueue ask_queue(const StudyJobs& jobs) {
  StudyQueue queue;
  // All of this user's jobs, since squeue rejects numbers of jobs that it has forgotten.
  const ProcessResult asked = run_process({"squeue", "--me", "--noheader", "--array", "--format=%F|%K|%T|%r"});
  if (!asked.is_found) return queue;
  if (asked.exit_code != 0) fail("squeue does not say what is queued: ", first_line(asked.errors));
  queue.is_known = true;
  std::istringstream lines(asked.output);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(without_line_end(line));
    std::string job, task, state, reason;
    std::getline(fields, job, '|');
    std::getline(fields, task, '|');
    std::getline(fields, state, '|');
    std::getline(fields, reason);
    for (const SubmittedJobs& one : jobs.submitted) {
      std::size_t shard = 0;
      if (job == one.merge) queue.merges.push_back(state);
      if (job != one.array || job.empty()) continue;
      const auto [end, error] = std::from_chars(task.data(), task.data() + task.size(), shard);
      if (error != std::errc{} || end != task.data() + task.size()) continue;
      queue.tasks[shard] = {state, reason};
      queue.names[shard] = std::string(job).append("_").append(task);
    }
  }
  return queue;
}

}  // namespace spinaltap
