#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/files/study_folder.h"
#include "core/study/study_row.h"
#include "core/study/study_shard.h"
#include "core/study/study_spec.h"
#include "core/study/study_work.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// Paths drilled, or screws graded, many times, with errors: on all cores, the same rows at any number of threads and
/// in any shards.
class Study {
 public:
  /// Looks at all bones; see survey_bones(). Throws Error as that does, and on runs that make no sense.
  explicit Study(StudySpec spec, const Progress& progress = {});
  /// From a SPEC.json: docs/studies.md.
  static Study load(const std::filesystem::path& spec, const Progress& progress = {});
  ~Study();
  Study(Study&&) noexcept;
  Study& operator=(Study&&) noexcept;
  Study(const Study&) = delete;
  Study& operator=(const Study&) = delete;

  /// With the cylinder's radius worked out, and all paths known.
  const StudySpec& spec() const;
  /// One of the spec's; the last that was asked for is kept.
  Bone bone(std::size_t n = 0) const;
  std::size_t run_count() const;
  /// All that the results depend on.
  const StudyIdentity& identity() const;
  /// That the last runs shared, and what a thread's copy of them takes; 0 before there was one.
  std::size_t points() const;
  std::size_t bytes_a_thread() const;

  /// The rows of a shard, in the order of their numbers. Throws Error where the path misses the bone.
  std::vector<StudyRow> run(const StudyShard& shard = {}, const Progress& progress = {}) const;
  /// As run(), into a folder that keeps each finished run whatever happens: called again it goes on where it was. Gives
  /// what it did now. Throws Error where the folder holds another study. Where `stops` says so it leaves early, after
  /// the runs under way (do_study_runs()).
  StudyWork run_into(const std::filesystem::path& folder, const StudyShard& shard = {}, const Progress& progress = {},
                     const StudyStop& stops = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The finished runs of a study, of one shard or more.
struct StudyTable {
  StudyIdentity identity;
  StudyRows rows;

  bool is_whole() const { return rows.size() == identity.runs; }
};
/// Joins what shards wrote. Throws Error on folders of different studies, and on one run with two results.
StudyTable merge(std::span<const std::filesystem::path> folders);

}  // namespace spinaltap
