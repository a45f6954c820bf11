#pragma once

#include <QElapsedTimer>
#include <QTimer>
#include <QWidget>
#include <functional>

#include "apps/spinaltap-planner/background_job.h"

class QProgressBar;

namespace spinaltap {

class ElidedLabel;

/// What a background job is at, how far it has come, how long it will take, and a button that ends it; hidden while
/// there is no work.
class JobBar : public QWidget {
  Q_OBJECT
 public:
  /// Its parts are named `prefix` and "working", "progress", "cancel". `job` must outlive it.
  JobBar(BackgroundJob& job, const QString& prefix, std::function<void()> cancel, QWidget* parent = nullptr);

 private:
  void show_words();

  BackgroundJob& job_;
  ElidedLabel* working_ = nullptr;
  QProgressBar* progress_ = nullptr;
  QElapsedTimer clock_;
  QTimer each_second_;
  QString stage_;
  double share_ = 0.0;
  bool is_ending_ = false;
};

}  // namespace spinaltap
