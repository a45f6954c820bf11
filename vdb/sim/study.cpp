#include "vdb/sim/study.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/files/study_folder.h"
#include "core/files/study_spec_file.h"
#include "core/study/study_task.h"
#include "vdb/sim/detail/study_survey.h"
#include "vdb/sim/study_run.h"

namespace spinaltap {

struct Study::State {
  State(StudySpec its_spec, const std::filesystem::path& folder, const Progress& progress)
      : spec(std::move(its_spec)),
        surveys(detail::survey_bones(spec, folder, progress)),
        runs(spec.design, ground_of(spec)) {
    reach_mm = radius_of_all_runs_mm(spec, runs, spec.lead_out_mm);  // and finds runs that make no sense
    if (spec.kind == StudyKind::drilling) spec.volume.radius_mm = study_radius_mm(spec, reach_mm);
    identity = study_identity(spec, runs);
  }

  std::vector<std::size_t> runs_of(const StudyShard& shard) const { return runs_of_shard(runs.count(), shard); }

  Bone bone(std::size_t n) const {
    const std::lock_guard lock(mutex);
    if (!known_bone || known_bone->first != n) {
      known_bone.reset();  // before the next one takes its room
      known_bone.emplace(n, Bone::load(spec.bones.at(n).file, spec.bones.at(n).level));
    }
    return known_bone->second;
  }
  /// Made for the first run of a screw, in place of the one before it.
  const StudyBench& bench(std::size_t screw, const Progress& progress) const {
    if (!made_bench || made_screw != screw) {
      made_bench.reset();
      made_bench.emplace(bone(screw_at(spec, screw).bone), spec, screw, runs, reach_mm, progress);
      made_screw = screw;
    }
    return *made_bench;
  }
  StudyWork work(const std::vector<std::size_t>& numbers, const std::function<void(const StudyRow&)>& finished,
                 const Progress& progress, const StudyStop& stops = {}) const {
    const std::lock_guard lock(work_mutex);
    // Screw by screw, so that one bone and its points are in memory at a time.
    std::map<std::size_t, std::vector<std::size_t>> by_screw;
    for (const std::size_t n : numbers) by_screw[runs.screw_of(n)].push_back(n);
    StudyWork all;
    for (const auto& [screw, of_screw] : by_screw) {
      if (all.is_stopped || (stops && stops())) {
        all.is_stopped = true;
        break;
      }
      const StudyBench& shared = bench(screw, progress);
      const StudyWork done = do_study_runs(of_screw, [&shared] { return shared.make_runner(); }, finished, progress,
                                           stops, {all.runs, numbers.size()});
      all.runs += done.runs;
      all.is_stopped = done.is_stopped;
      all.threads = std::max(all.threads, done.threads);
      all.seconds += done.seconds;
      all.cpu_seconds += done.cpu_seconds;
    }
    return all;
  }

  StudySpec spec;
  std::vector<std::string> surveys;  ///< their keys
  StudyRuns runs;
  double reach_mm = 0.0;
  StudyIdentity identity;
  mutable std::mutex mutex, work_mutex;
  mutable std::optional<std::pair<std::size_t, Bone>> known_bone;
  mutable std::optional<StudyBench> made_bench;
  mutable std::size_t made_screw = 0;
};

Study::Study(StudySpec spec, const Progress& progress, const std::filesystem::path& folder)
    : state_(std::make_unique<State>(std::move(spec), folder, progress)) {}
Study Study::load(const std::filesystem::path& spec, const Progress& progress, const std::filesystem::path& folder) {
  return Study(read_study_spec(spec), progress, folder);
}
Study::~Study() = default;
Study::Study(Study&&) noexcept = default;
Study& Study::operator=(Study&&) noexcept = default;

const StudySpec& Study::spec() const { return state_->spec; }
Bone Study::bone(std::size_t n) const { return state_->bone(n); }
std::size_t Study::run_count() const { return state_->runs.count(); }
const StudyIdentity& Study::identity() const { return state_->identity; }
std::size_t Study::points() const { return state_->made_bench ? state_->made_bench->point_count() : 0; }
std::size_t Study::bytes_a_thread() const { return state_->made_bench ? state_->made_bench->memory_bytes() : 0; }

void Study::open_folder(const std::filesystem::path& folder) const {
  open_study_folder(folder, state_->identity);
  detail::keep_surveys(state_->spec, state_->surveys, folder);
}

std::vector<StudyRow> Study::run(const StudyShard& shard, const Progress& progress) const {
  std::vector<StudyRow> rows;
  state_->work(
      state_->runs_of(shard), [&rows](const StudyRow& row) { rows.push_back(row); }, progress);
  std::sort(rows.begin(), rows.end(), [](const StudyRow& a, const StudyRow& b) { return a.run() < b.run(); });
  return rows;
}

StudyWork Study::run_into(const std::filesystem::path& folder, const StudyShard& shard, const Progress& progress,
                          const StudyStop& stops) const {
  std::vector<std::size_t> left = state_->runs_of(shard);
  // What makes no sense leaves no files behind. In a folder that is this study's, it made sense before.
  if (!std::filesystem::exists(folder) || std::filesystem::is_empty(folder)) state_->bench(0, progress);
  open_folder(folder);
  {
    StudyRows done;
    read_study_parts(folder, state_->identity, done);
    std::erase_if(left, [&done](std::size_t n) { return done.contains(n); });
  }
  if (left.empty()) return {};
  StudyPart part(folder, "part-" + std::to_string(shard.index) + "-of-" + std::to_string(shard.count) + ".csv",
                 state_->identity);
  StudyWork work = state_->work(
      left, [&part](const StudyRow& row) { part.append(study_csv(row)); }, progress, stops);
  if (!part.is_locked()) work.unlocked_part = part.path();
  return work;
}

ShardProgress StudyTable::progress_of(const StudyShard& shard) const {
  const std::vector<std::size_t> numbers = runs_of_shard(identity.runs, shard);
  const auto done = std::count_if(numbers.begin(), numbers.end(), [&](std::size_t n) { return rows.contains(n); });
  return {numbers.size(), static_cast<std::size_t>(done)};
}

StudyTable merge(std::span<const std::filesystem::path> folders) {
  if (folders.empty()) fail("expected folders of a study's shards, found none");
  StudyTable table{read_study_identity(folders.front()), {}};
  for (const std::filesystem::path& folder : folders) {
    if (read_study_identity(folder).study != table.identity.study) {
      fail("expected shards of one study, found one study in ", folders.front().string(), " and another in ",
           folder.string());
    }
    read_study_parts(folder, table.identity, table.rows);
  }
  return table;
}

}  // namespace spinaltap
