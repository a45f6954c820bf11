#include <sys/stat.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "apps/spinaltap/cluster/study_commands.h"
#include "apps/spinaltap/cluster/study_jobs.h"
#include "core/base/text_writer.h"
#include "core/study/study_shard.h"
#include "vdb/sim/study.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

struct StatusOptions {
  fs::path folder;
  bool shows_all = false;
};

/// What a part file's name says: "part-3-of-8.csv" is shard 3 of 8. Nothing of other names.
std::optional<StudyShard> shard_of(const std::string& name) {
  constexpr std::string_view kPart = "part-", kOf = "-of-";
  if (!name.starts_with(kPart)) return std::nullopt;
  StudyShard shard;
  const char* const end = name.data() + name.size();
  const auto [middle, first] = std::from_chars(name.data() + kPart.size(), end, shard.index);
  if (first != std::errc{} || !std::string_view(middle, end).starts_with(kOf)) return std::nullopt;
  const auto [rest, second] = std::from_chars(middle + kOf.size(), end, shard.count);
  if (second != std::errc{} || rest == end || *rest != '.') return std::nullopt;
  return shard;
}

/// Seconds since 1970 at which a run was last finished, by shard; 0 for the last of all, whatever shards they are of.
std::map<std::size_t, std::int64_t> last_activity(const fs::path& folder, std::size_t shards) {
  std::map<std::size_t, std::int64_t> last;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const std::optional<StudyShard> shard = shard_of(name);
    if (!shard) continue;
    struct stat status {};
    if (::stat(entry.path().c_str(), &status) != 0) continue;
    const auto time_s = static_cast<std::int64_t>(status.st_mtim.tv_sec);
    last[0] = std::max(last[0], time_s);
    if (shard->count == shards) last[shard->index] = std::max(last[shard->index], time_s);
  }
  return last;
}

/// "12 s", "3 min", "5.2 h"
std::string duration_text(double seconds) {
  if (seconds < 120.0) return fixed_text(seconds, 0) + " s";
  if (seconds < 7200.0) return fixed_text(seconds / 60.0, 0) + " min";
  return fixed_text(seconds / 3600.0, 1) + " h";
}

Json run_status(const StatusOptions& options) {
  const StudyJobs jobs = read_study_jobs(options.folder);
  const StudyTable table = merge({&options.folder, 1});
  const StudyQueue queue = ask_queue(jobs);
  const std::size_t shards = jobs.study.shards;
  const std::size_t left = table.identity.runs - table.rows.size();
  const std::map<std::size_t, std::int64_t> last = last_activity(options.folder, shards);
  const auto now_s = static_cast<std::int64_t>(std::time(nullptr));

  Json figures{{"runs", table.identity.runs}, {"done", table.rows.size()}, {"left", left}};
  print_figure("runs done", std::to_string(table.rows.size()) + " of " + std::to_string(table.identity.runs));
  if (last.contains(0)) {
    figures["last_activity_s_ago"] = now_s - last.at(0);
    print_figure("last run finished", duration_text(static_cast<double>(now_s - last.at(0))) + " ago");
    const SubmittedJobs newest = jobs.submitted.empty() ? SubmittedJobs{} : jobs.submitted.back();
    if (newest.time_s > 0 && last.at(0) > newest.time_s && table.rows.size() > newest.runs_done) {
      const double rate =
          static_cast<double>(table.rows.size() - newest.runs_done) / static_cast<double>(last.at(0) - newest.time_s);
      figures["runs_per_s"] = rate;
      print_figure("rate since it was submitted", rate, "runs/s");
      if (left > 0) print_figure("  at that rate left", duration_text(static_cast<double>(left) / rate));
    }
  }
  std::map<std::string, std::size_t> states;
  for (const auto& [shard, task] : queue.tasks) ++states[task.state];
  std::string text;
  for (const auto& [state, count] : states) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + state;
  figures["queue"] = Json(states);
  print_figure("tasks in Slurm's queue", !queue.is_known ? "no squeue on this computer" : text.empty() ? "none" : text);
  figures["merge"] = queue.merges.empty() ? "" : queue.merges.back();
  const bool has_results = left == 0 && fs::exists(options.folder / "runs.csv");
  print_figure("merge", has_results            ? (options.folder / "report.html").string()
                        : queue.merges.empty() ? "not in the queue"
                                               : queue.merges.back());

  figures["shards"] = Json::array();
  constexpr std::size_t kMaxLines = 40;
  std::size_t lines = 0, hidden = 0, lost = 0;
  for (std::size_t shard = 1; shard <= shards; ++shard) {
    const ShardProgress so_far = table.progress_of({shard, shards});
    const auto task = queue.tasks.find(shard);
    const bool is_queued = task != queue.tasks.end();
    std::string state = so_far.is_done() ? "done" : is_queued ? task->second.state : "not in the queue";
    if (!so_far.is_done() && !is_queued) ++lost;
    Json one{{"shard", shard}, {"runs", so_far.runs}, {"done", so_far.done}, {"state", state}};
    if (is_queued && task->second.state == "PENDING") state += " (" + task->second.reason + ")";
    if (last.contains(shard)) {
      one["last_activity_s_ago"] = now_s - last.at(shard);
      state += ", last run " + duration_text(static_cast<double>(now_s - last.at(shard))) + " ago";
    }
    figures["shards"].push_back(one);
    if (so_far.is_done() && !options.shows_all) continue;
    if (++lines > kMaxLines && !options.shows_all) {
      ++hidden;
      continue;
    }
    print_figure("shard " + std::to_string(shard),
                 std::to_string(so_far.done) + " of " + std::to_string(so_far.runs) + ", " + state);
  }
  if (hidden > 0) print_figure("further shards", std::to_string(hidden) + ": --all shows them");
  if (lost > 0 && queue.is_known) {
    print_figure("to go on with", "spinaltap study resume " + options.folder.string() +
                                      "; why they ended: " + (options.folder / kSlurmLogs).string());
  }
  return figures;
}

}  // namespace

void add_study_status(CLI::App& program, Command& command) {
  const auto options = std::make_shared<StatusOptions>();
  CLI::App* app = add_command(*program.get_subcommand("study"), command, "status",
                              "How far a submitted study has come: runs, rate, shards that are not done, Slurm's queue",
                              "Example: spinaltap study status study/");
  app->add_option("folder", options->folder, "Folder that study submit was given")->required()->type_name("FOLDER");
  app->add_flag("--all", options->shows_all, "Lists the shards that are done too, and all of the others");
  command.run = [options](const Progress&) { return run_status(*options); };
}

}  // namespace spinaltap
