#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace spinaltap {

/// What a study is, down to the last number that its results depend on; two studies with the same are one.
struct StudyIdentity {
  std::string study;  ///< all inputs, with the bone's fingerprint and the program's version: JSON on one line
  std::size_t runs = 0;

  /// A fingerprint of it, hexadecimal.
  std::string hash() const;
};

/// Rows of finished runs by number, as text: study_csv(). Text, since it is what must come out the same.
using StudyRows = std::map<std::size_t, std::string>;

/// One of the shares that a study is cut into: neighbouring runs, so that it meets few bones.
struct StudyShard {
  std::size_t index = 1;
  std::size_t count = 1;
};

/// The numbers of a shard's runs, in order, of a study of `runs`. Throws Error where the index is not 1 to the count.
std::vector<std::size_t> runs_of_shard(std::size_t runs, const StudyShard& shard);

/// What the runs took.
struct StudyWork {
  std::size_t runs = 0;
  int threads = 1;
  double seconds = 0.0;                   ///< by the clock
  double cpu_seconds = 0.0;               ///< of the whole process
  bool is_stopped = false;                ///< runs are left, since it was asked to stop
  std::filesystem::path unlocked_part{};  ///< where the file system has no locks: the file of rows that is ours alone
};

/// Asked before each run, from any thread: true where no further one shall begin.
using StudyStop = std::function<bool()>;

}  // namespace spinaltap
