#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/spinaltap/cluster/slurm_script.h"

namespace spinaltap {

/// One time that a study was handed to Slurm.
struct SubmittedJobs {
  std::string array;          ///< number of the array's job; empty: only the merge was submitted
  std::string merge;          ///< of the merge's
  std::int64_t time_s = 0;    ///< since 1970
  std::size_t runs_done = 0;  ///< there were before
};

/// How a study's folder came to Slurm: jobs.json.
struct StudyJobs {
  SlurmStudy study;
  std::vector<SubmittedJobs> submitted;
};

std::filesystem::path jobs_file(const std::filesystem::path& folder);
/// Throws Error where the folder was never submitted.
StudyJobs read_study_jobs(const std::filesystem::path& folder);
void write_study_jobs(const StudyJobs& jobs);

/// Runs sbatch and gives the job's number. Throws Error with what sbatch said.
std::string submit_job(const std::vector<std::string>& words);

/// A task, or a job that is no array, that Slurm has in its queue.
struct QueuedTask {
  std::string state;   ///< as squeue has it: PENDING, RUNNING, ...
  std::string reason;  ///< why it waits
};

/// What is queued of a study.
struct StudyQueue {
  bool is_known = false;                     ///< there is a Slurm
  std::map<std::size_t, QueuedTask> tasks;   ///< by shard
  std::map<std::size_t, std::string> names;  ///< and how Slurm calls them: "17_3"
  std::vector<std::string> merges;           ///< states of the merges that wait or run
};

/// Asks squeue. Throws Error where there is one that does not answer.
StudyQueue ask_queue(const StudyJobs& jobs);

}  // namespace spinaltap
