#include "apps/spinaltap-planner/window/job_bar.h"

#include <QHBoxLayout>
#include <QProgressBar>
#include <QToolButton>
#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/spinaltap-planner/window/elided_label.h"

namespace spinaltap {
namespace {

/// "8 s", "40 s", "3 min": no more exact than it is known.
QString about(double seconds) {
  constexpr double kMinute = 60.0, kFew = 10.0;
  if (seconds >= 2.0 * kMinute) return JobBar::tr("%1 min").arg(std::lround(seconds / kMinute));
  const double step = seconds < kFew ? 1.0 : 5.0;
  return JobBar::tr("%1 s").arg(std::lround(std::max(1.0, std::ceil(seconds / step)) * step));
}

}  // namespace

JobBar::JobBar(BackgroundJob& job, const QString& prefix, std::function<void()> cancel, QWidget* parent)
    : QWidget(parent), job_(job) {
  const auto name = [&](const char* part) {
    QString text = prefix + part;
    if (!prefix.isEmpty()) text[prefix.size()] = text[prefix.size()].toUpper();
    return text;
  };
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  working_ = new ElidedLabel;
  working_->setObjectName(name("working"));
  progress_ = new QProgressBar;
  progress_->setObjectName(name("progress"));
  progress_->setRange(0, 100);
  progress_->setFixedWidth(120);
  auto* button = new QToolButton;
  button->setObjectName(name("cancel"));
  button->setText(tr("Cancel"));
  button->setFocusPolicy(Qt::StrongFocus);
  layout->addWidget(working_);
  layout->addWidget(progress_);
  layout->addWidget(button);
  hide();
  connect(button, &QToolButton::clicked, this, [this, cancel = std::move(cancel)] {
    is_ending_ = true;
    cancel();
    show_words();
  });
  connect(&job, &BackgroundJob::started, this, [this] {
    clock_.start();
    stage_.clear();
    share_ = 0.0;
    is_ending_ = false;
    each_second_.start(1000);
    show_words();
    show();
  });
  connect(&job, &BackgroundJob::progressed, this, [this](const QString& stage, double share) {
    stage_ = stage;
    share_ = share;
    show_words();
  });
  connect(&job, &BackgroundJob::finished, this, [this] {
    if (job_.is_running()) return;  // the next has begun while a box told of this one's end
    each_second_.stop();
    hide();
  });
  connect(&each_second_, &QTimer::timeout, this, &JobBar::show_words);
}

void JobBar::show_words() {
  constexpr double kMinS = 1.5, kMinShare = 0.03;  // before that nothing is known
  const double passed_s = 1e-3 * static_cast<double>(clock_.elapsed());
  QString words = job_.what();
  if (is_ending_) {
    words = tr("%1: ending").arg(words);
  } else {
    if (!stage_.isEmpty()) words += ": " + stage_;
    if (passed_s >= kMinS && share_ >= kMinShare && share_ < 1.0) {
      words += tr(", about %1 left").arg(about(passed_s * (1.0 - share_) / share_));
    }
  }
  working_->set_text(words);
  progress_->setValue(static_cast<int>(100.0 * share_));
}

}  // namespace spinaltap
