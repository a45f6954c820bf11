#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/study/study_row.h"
#include "core/study/study_shard.h"
#include "core/study/study_spec.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// Paths drilled, or screws graded, many times, with errors: on all cores, the same rows at any number of threads and
/// in any shards.
class Study {
 public:
  /// Looks at all bones. `folder`, which need not exist: of an earlier run_into(), which kept what was found of bones
  /// that are as they were. Throws Error as Bone::load() does, on bones where a path is to be suggested, or errors are
  /// to be told, and cannot, and on runs that make no sense.
  explicit Study(StudySpec spec, const Progress& progress = {}, const std::filesystem::path& folder = {});
  /// From a SPEC.json: docs/studies.md.
  static Study load(const std::filesystem::path& spec, const Progress& progress = {},
                    const std::filesystem::path& folder = {});
  ~Study();
  Study(Study&&) noexcept;
  Study& operator=(Study&&) noexcept;
  Study(const Study&) = delete;
  Study& operator=(const Study&) = delete;

  /// With the cylinder's radius worked out, and all paths known.
  const StudySpec& spec() const;
  /// One of the spec's; the last that was asked for is kept.
  Bone bone(std::size_t n = 0) const;
  /// Of all shards.
  std::size_t run_count() const;
  /// All that the results depend on.
  const StudyIdentity& identity() const;
  /// That the last runs shared, and what a thread's copy of them takes; 0 before there was one.
  std::size_t points() const;
  std::size_t bytes_a_thread() const;

  /// Makes the folder, or finds it, and keeps there what is known of the bones, for the next one that looks at them.
  /// Throws Error where it holds another study.
  void open_folder(const std::filesystem::path& folder) const;
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

/// How many runs a shard has, and how many of them are done.
struct ShardProgress {
  std::size_t runs = 0;
  std::size_t done = 0;
  bool is_done() const { return done == runs; }
};

/// The finished runs of a study, of one shard or more.
struct StudyTable {
  StudyIdentity identity;
  StudyRows rows;

  bool is_whole() const { return rows.size() == identity.runs; }
  /// How far a shard is. Throws Error as runs_of_shard() does.
  ShardProgress progress_of(const StudyShard& shard) const;
};
/// Joins what shards wrote. Throws Error on folders of different studies, and on one run with two results.
StudyTable merge(std::span<const std::filesystem::path> folders);

}  // namespace spinaltap
