#include "apps/spinaltap-planner/background_job.h"

#include <QEventLoop>
#include <QMetaObject>
#include <algorithm>
#include <exception>
#include <memory>
#include <new>
#include <utility>

#include "core/base/error.h"

namespace spinaltap {

namespace {

/// The share of all stages that is done, from the shares of each. Stages that it does not know, or that come again, are
/// parts of the last one.
class WholeShare {
 public:
  explicit WholeShare(std::vector<JobStage> stages) : stages_(std::move(stages)) {
    for (const JobStage& stage : stages_) total_ += stage.weight;
  }

  double at(std::string_view name, double fraction) {
    if (stages_.empty()) return fraction;
    double before = 0.0;
    for (const JobStage& stage : stages_) {
      if (stage.name == name) share_ = std::max(share_, (before + stage.weight * fraction) / total_);
      before += stage.weight;
    }
    return share_;
  }

 private:
  std::vector<JobStage> stages_;
  double total_ = 0.0, share_ = 0.0;
};

}  // namespace

BackgroundJob::BackgroundJob(QObject* parent) : QObject(parent) {}

BackgroundJob::~BackgroundJob() {
  cancel();
  if (thread_.joinable()) thread_.join();
}

void BackgroundJob::start(const QString& what, std::function<std::function<void()>(const Progress&)> work,
                          const std::vector<JobStage>& stages) {
  if (is_running()) fail("expected no other work while ", what_.toStdString(), " runs");
  what_ = what;
  is_cancelled_ = false;
  progress_ = Progress([this, whole = std::make_shared<WholeShare>(stages)](std::string_view stage, double fraction) {
    const double share = whole->at(stage, fraction);
    const QString name = QString::fromUtf8(stage.data(), static_cast<int>(stage.size()));
    QMetaObject::invokeMethod(
        this, [this, name, share] { Q_EMIT progressed(name, share); }, Qt::QueuedConnection);
  });
  thread_ = std::thread([this, work = std::move(work), progress = progress_] {
    std::function<void()> deliver;
    QString trouble;
    bool was_cancelled = false;
    try {
      deliver = work(progress);
    } catch (const Cancelled&) {
      was_cancelled = true;
    } catch (const std::bad_alloc&) {
      trouble = tr("not enough memory");
    } catch (const std::exception& error) {
      trouble = QString::fromUtf8(error.what());
    }
    QMetaObject::invokeMethod(
        this, [this, deliver, trouble, was_cancelled] { finish(deliver, trouble, was_cancelled); },
        Qt::QueuedConnection);
  });
  Q_EMIT started(what_);
}

void BackgroundJob::cancel() {
  if (!is_running()) return;
  is_cancelled_ = true;
  progress_.cancel();
}

void BackgroundJob::wait() {
  if (!is_running()) return;
  QEventLoop loop;
  connect(this, &BackgroundJob::finished, &loop, &QEventLoop::quit);
  loop.exec(QEventLoop::ExcludeUserInputEvents);
}

void BackgroundJob::finish(const std::function<void()>& deliver, const QString& trouble, bool was_cancelled) {
  thread_.join();
  QString told = trouble;
  const bool is_done = !was_cancelled && !is_cancelled_ && trouble.isEmpty();
  if (is_done && deliver) {
    try {
      deliver();
    } catch (const std::exception& error) {
      told = QString::fromUtf8(error.what());
    }
  }
  Q_EMIT finished(is_done && told.isEmpty(), told);
}

}  // namespace spinaltap
