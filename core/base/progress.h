#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string_view>

namespace spinaltap {

/// Tells a caller how far long work has come, and lets the caller stop it.
///
/// Copies share one state. A default-made Progress reports to nobody and is never cancelled, so functions take
/// `const Progress& progress = {}`. Libraries never print; a program's callback does.
class Progress {
 public:
  /// Called with the name of the stage and the share of it that is done, 0 to 1. Calls never overlap.
  using Callback = std::function<void(std::string_view stage, double fraction)>;

  Progress() = default;
  explicit Progress(Callback callback);

  /// Reports from any thread; throws Cancelled when cancel() was called.
  void report(std::string_view stage, double fraction) const;

  /// Asks the work to stop at its next report. Lock-free, so that a signal handler may call it.
  void cancel() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

/// Counts finished pieces of one stage from many threads and reports each whole percent once.
class ProgressCounter {
 public:
  /// `total` pieces make the stage; `stage` must outlive the counter.
  ProgressCounter(const Progress& progress, std::string_view stage, std::size_t total);

  /// Adds `pieces` finished pieces; throws Cancelled when the work was cancelled.
  void add(std::size_t pieces = 1);

 private:
  const Progress& progress_;
  std::string_view stage_;
  std::size_t total_;
  std::atomic<std::size_t> done_{0};
};

}  // namespace spinaltap
