#include "vdb/sim/study.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/files/study_folder.h"
#include "core/files/study_spec_file.h"
#include "vdb/sim/study_run.h"

namespace spinaltap {

struct Study::State {
  explicit State(StudySpec its_spec) : spec(std::move(its_spec)), runs(spec.design) {
    spec.volume.radius_mm = study_radius_mm(spec, runs);
    bone.emplace(Bone::load(spec.bone_file, spec.level));
    identity = study_identity(spec, runs, bone->hash());
  }

  std::vector<std::size_t> runs_of(const StudyShard& shard) const { return runs_of_shard(runs.count(), shard); }
  /// Made for the first run: a folder whose runs are all done needs none.
  const StudyBench& bench(const Progress& progress) const {
    std::call_once(has_bench, [&] { made_bench.emplace(*bone, spec, runs, progress); });
    return *made_bench;
  }
  StudyWork work(std::span<const std::size_t> numbers, const std::function<void(const StudyRow&)>& finished,
                 const Progress& progress, const StudyStop& stops = {}) const {
    const StudyBench& shared = bench(progress);
    return do_study_runs(
        numbers, [&shared] { return shared.make_runner(); }, finished, progress, stops);
  }

  StudySpec spec;
  StudyRuns runs;
  std::optional<Bone> bone;
  StudyIdentity identity;
  mutable std::once_flag has_bench;
  mutable std::optional<StudyBench> made_bench;
};

Study::Study(StudySpec spec) : state_(std::make_unique<State>(std::move(spec))) {}
Study Study::load(const std::filesystem::path& spec) { return Study(read_study_spec(spec)); }
Study::~Study() = default;
Study::Study(Study&&) noexcept = default;
Study& Study::operator=(Study&&) noexcept = default;

const StudySpec& Study::spec() const { return state_->spec; }
const Bone& Study::bone() const { return *state_->bone; }
std::size_t Study::run_count() const { return state_->runs.count(); }
const StudyIdentity& Study::identity() const { return state_->identity; }
std::size_t Study::points() const { return state_->bench({}).point_count(); }
std::size_t Study::bytes_a_thread() const { return state_->bench({}).memory_bytes(); }

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
  if (!std::filesystem::exists(folder) || std::filesystem::is_empty(folder)) state_->bench(progress);
  open_study_folder(folder, state_->identity);
  StudyRows done;
  read_study_parts(folder, state_->identity, done);
  std::erase_if(left, [&done](std::size_t n) { return done.contains(n); });
  if (left.empty()) return {};
  StudyPart part(folder, "part-" + std::to_string(shard.index) + "-of-" + std::to_string(shard.count) + ".csv",
                 state_->identity);
  StudyWork work = state_->work(
      left, [&part](const StudyRow& row) { part.append(study_csv(row)); }, progress, stops);
  if (!part.is_locked()) work.unlocked_part = part.path();
  return work;
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
