#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace spinaltap {

/// What Slurm is asked for; empty: as the cluster has it.
struct SlurmOptions {
  std::string partition;
  std::string account;
  std::string time;                 ///< limit of a task, as sbatch takes it
  std::string mem;                  ///< of a task
  int cpus = 1;                     ///< of a task: threads of the study
  int at_once = 0;                  ///< tasks that run at the same time at most; 0: no limit
  std::vector<std::string> extras;  ///< further options of sbatch, each as "--constraint=avx2"
};

/// A study as Slurm runs it: an array with a task a shard.
struct SlurmStudy {
  std::filesystem::path program;  ///< spinaltap
  std::filesystem::path spec;
  std::filesystem::path folder;  ///< for its results; the scripts' folder too
  std::string name;
  std::size_t shards = 1;
  SlurmOptions options;
};

constexpr const char* kArrayScript = "study.sbatch";
constexpr const char* kMergeScript = "merge.sbatch";
/// Where tasks' outputs go, below the study's folder.
constexpr const char* kSlurmLogs = "slurm";

/// Scripts for sbatch, for people to read and change. Throw Error on an option that would be more than a line.
std::string array_script(const SlurmStudy& study);
std::string merge_script(const SlurmStudy& study);

/// What sbatch is called with. `shards`: those to do, empty for all; `after`: jobs and tasks that the merge waits for.
std::vector<std::string> submit_array(const SlurmStudy& study, const std::vector<std::size_t>& shards);
std::vector<std::string> submit_merge(const SlurmStudy& study, const std::vector<std::string>& after);

/// Numbers as Slurm has them: "1-3,7".
std::string slurm_ranges(const std::vector<std::size_t>& numbers);

/// Seconds as a limit for sbatch, in whole minutes: "1-02:30:00".
std::string slurm_time(double seconds);

}  // namespace spinaltap
