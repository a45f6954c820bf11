#pragma once

#include <QObject>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "core/base/progress.h"

namespace spinaltap {

/// A stage of long work, named as Progress names it, and how long it takes of the whole, in any unit.
struct JobStage {
  std::string name;
  double weight = 1.0;
};

/// Long work beside the window: one piece at a time, on a thread of its own, with progress and cancel. All signals come
/// on the thread that owns this.
class BackgroundJob : public QObject {
  Q_OBJECT
 public:
  explicit BackgroundJob(QObject* parent = nullptr);
  /// Cancels, and waits.
  ~BackgroundJob() override;

  /// `work` runs on the other thread and returns what the owner's thread does with its result, at the end, unless it
  /// was cancelled by then. `stages`: in their order; none: the work has but one. Throws Error while other work runs.
  void start(const QString& what, std::function<std::function<void()>(const Progress&)> work,
             const std::vector<JobStage>& stages = {});
  bool is_running() const { return thread_.joinable(); }
  const QString& what() const { return what_; }
  /// Asks the work to stop: finished() comes when it has.
  void cancel();
  /// Until it has, with the window at work meanwhile but deaf to mouse and keys.
  void wait();

 Q_SIGNALS:
  void started(const QString& what);
  void progressed(const QString& stage, double share);  ///< of all of the work, 0 to 1: it does not fall
  /// `trouble`: what went wrong, in words; empty where all is well or it was cancelled.
  void finished(bool is_done, const QString& trouble);

 private:
  void finish(const std::function<void()>& deliver, const QString& trouble, bool was_cancelled);

  QString what_;
  Progress progress_;
  std::thread thread_;
  bool is_cancelled_ = false;
};

}  // namespace spinaltap
