// What opens, and what could be lost by it, by closing or by a crash.
#include <QCloseEvent>
#include <QFileInfo>
#include <QInputDialog>
#include <QLocale>
#include <QMessageBox>
#include <QPushButton>
#include <QSettings>
#include <QStatusBar>

#include "apps/spinaltap-planner/window/main_window.h"
#include "apps/spinaltap-planner/window/words.h"
#include "core/base/error.h"
#include "vdb/grid/spine_file.h"

namespace spinaltap {

void MainWindow::connect_questions() {
  Questions questions;
  questions.before_replacing = [this](const std::function<void()>& show) {
    const bool is_agreed = given_up_ && *given_up_ == current_work();
    if (is_agreed || (!planner_.has_unsaved_changes() && !planner_.player().has_unsaved())) {
      show();
      return;
    }
    // Not from within the work's end: a box holds up whoever opens it.
    QTimer::singleShot(0, this, [this, show] { offer_what_opened(show); });
  };
  questions.which_series = [this](const std::filesystem::path& path, const OpenOptions& options,
                                  const SeveralSeries& several) {
    QTimer::singleShot(0, this, [this, path, options, several] { ask_series(path, options, several); });
  };
  questions.whether_to_resample = [this](const std::filesystem::path& path, const OpenOptions& options,
                                         const UnevenSlices& uneven) {
    QTimer::singleShot(0, this, [this, path, options, uneven] { ask_resampling(path, options, uneven); });
  };
  questions.whether_to_take_plan = [this](const std::filesystem::path& file, const QString& why,
                                          const std::function<void()>& take) {
    QTimer::singleShot(0, this, [this, file, why, take] { ask_plan(file, why, take); });
  };
  planner_.set_questions(std::move(questions));
  connect(&planner_, &Planner::no_bone, this, [this](const QString& why) {
    tell(tr("No vertebra was found in this CT."), tr("%1.\n\nIts slices are shown: put the crosshair into the middle "
                                                     "of a vertebral body and take File > Bake the "
                                                     "vertebra at the crosshair (Ctrl+B).")
                                                      .arg(why));
  });
  connect(&planner_, &Planner::opened, this, &MainWindow::take_back);
}

void MainWindow::offer_what_opened(const std::function<void()>& show) {
  statusBar()->showMessage(tr("What was opened is ready"));
  if (may_lose_work([this, show] { offer_what_opened(show); })) {
    show();
  } else if (!after_job_) {
    statusBar()->showMessage(tr("What is open stays; what was opened is not shown"), 8000);
  }
}

void MainWindow::run_alone() {
  planner_.set_questions({});
  QObject::disconnect(&planner_, &Planner::trouble, this, nullptr);
  QObject::disconnect(&planner_, &Planner::no_bone, this, nullptr);
  QObject::disconnect(&planner_.player(), &DrillPlayer::failed, this, nullptr);
  autosave_.reset();
}

std::optional<Level> MainWindow::ask_level(const std::filesystem::path& path) {
  const std::vector<Level> levels = levels_in(path);
  if (levels.size() < 2) return Level::kNone;
  QStringList names;
  for (const Level level : levels) names += text_of(level_name(level));
  bool is_chosen = false;
  const QString name = QInputDialog::getItem(this, tr("SpinalTap planner"), tr("Which vertebra of this file?"), names,
                                             0, false, &is_chosen);
  if (!is_chosen) return std::nullopt;
  return levels[static_cast<std::size_t>(names.indexOf(name))];
}

void MainWindow::open(const std::filesystem::path& path, const OpenOptions& options) {
  attempt(tr("Cannot open %1").arg(text_of(path.string())), [&] {
    const FileKind kind = kind_of_file(path);
    // Holes are the bone's: another plan leaves them.
    const bool may =
        kind == FileKind::plan ? may_lose_plan() : may_lose_work([this, path, options] { open(path, options); });
    if (!may) return;
    if (kind != FileKind::bone || options.level != Level::kNone) {
      open_at_once(path, options);
    } else if (const std::optional<Level> level = ask_level(path)) {
      OpenOptions chosen = options;
      chosen.level = *level;
      open_at_once(path, chosen);
    }
  });
}

void MainWindow::open_at_once(const std::filesystem::path& path, const OpenOptions& options) {
  attempt(tr("Cannot open %1").arg(text_of(path.string())), [&] {
    planner_.open(path, options);
    given_up_ = current_work();
  });
}

void MainWindow::ask_series(const std::filesystem::path& path, OpenOptions options, const SeveralSeries& several) {
  QStringList names;
  for (const SeriesInfo& one : several.series) {
    QString name = tr("%1: %2, %3 x %4, %n slice(s)", nullptr, one.slices)
                       .arg(one.number)
                       .arg(text_of(one.modality))
                       .arg(one.columns)
                       .arg(one.rows);
    if (one.layout) {
      name += tr(", %1, every %2 mm")
                  .arg(text_of(plane_name(one.layout->directions.col(2))))
                  .arg(one.layout->min_step_mm, 0, 'f', 2);
    }
    names += name;
  }
  QInputDialog box(this);
  box.setObjectName("series");
  box.setWindowTitle(tr("SpinalTap planner"));
  box.setLabelText(tr("%1 holds several series. Which one?").arg(text_of(path.filename().string())));
  box.setComboBoxItems(names);
  if (box.exec() != QDialog::Accepted) return;
  const auto chosen = static_cast<int>(names.indexOf(box.textValue()));
  if (chosen < 0) return;
  options.reading.series = std::to_string(several.series[static_cast<std::size_t>(chosen)].number);
  open(path, options);
}

void MainWindow::ask_resampling(const std::filesystem::path& path, OpenOptions options, const UnevenSlices& uneven) {
  QMessageBox box(QMessageBox::Question, tr("SpinalTap planner"), tr("The slices of this CT have gaps."),
                  QMessageBox::Yes | QMessageBox::Cancel, this);
  box.setObjectName("uneven");
  box.setInformativeText(
      tr("%1.\n\nThey can be interpolated from their neighbours. What lies in a gap is then a guess.")
          .arg(text_of(uneven.found)));
  box.button(QMessageBox::Yes)->setText(tr("&Interpolate"));
  box.setDefaultButton(QMessageBox::Cancel);
  if (box.exec() != QMessageBox::Yes) return;
  options.reading.resample = true;
  open(path, options);
}

void MainWindow::ask_plan(const std::filesystem::path& file, const QString& why, const std::function<void()>& take) {
  QMessageBox box(QMessageBox::Warning, tr("SpinalTap planner"),
                  tr("%1 does not fit this bone.").arg(text_of(file.filename().string())),
                  QMessageBox::Open | QMessageBox::Cancel, this);
  box.setObjectName("otherPlan");
  box.setInformativeText(why);
  box.button(QMessageBox::Open)->setText(tr("&Open it all the same"));
  box.setDefaultButton(QMessageBox::Cancel);
  if (box.exec() != QMessageBox::Open) return;
  attempt(tr("Cannot open %1").arg(text_of(file.string())), [&] {
    take();
    given_up_ = current_work();
  });
}

bool MainWindow::may_lose_plan() {
  if (!planner_.has_unsaved_changes()) return true;
  QMessageBox box(QMessageBox::Question, tr("SpinalTap planner"), tr("The plan has changes that are not saved."),
                  QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel, this);
  box.setObjectName("unsaved");
  box.setDefaultButton(QMessageBox::Save);
  switch (box.exec()) {
    case QMessageBox::Save:
      return save_plan();
    case QMessageBox::Discard:
      return true;
    default:
      return false;
  }
}

bool MainWindow::may_lose_drilling(const std::function<void()>& again) {
  if (!planner_.player().has_unsaved()) return true;
  QMessageBox box(QMessageBox::Question, tr("SpinalTap planner"),
                  tr("The drilling is not saved: there is no record and no report of it."),
                  QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel, this);
  box.setObjectName("unsavedDrilling");
  box.button(QMessageBox::Save)->setText(tr("&Save the record..."));
  box.setDefaultButton(QMessageBox::Save);
  switch (box.exec()) {
    case QMessageBox::Save:
      planner_.player().stop();
      if (save_record()) after_job_ = again;
      return false;
    case QMessageBox::Discard:
      return true;
    default:
      return false;
  }
}

bool MainWindow::may_lose_work(const std::function<void()>& again) {
  return may_lose_drilling(again) && may_lose_plan();
}

bool MainWindow::may_replace(const QString& what, const QString& where) {
  QMessageBox box(QMessageBox::Question, tr("SpinalTap planner"), tr("Replace %1?").arg(what),
                  QMessageBox::Yes | QMessageBox::No, this);
  box.setObjectName("replace");
  box.setInformativeText(where);
  box.setDefaultButton(QMessageBox::No);
  box.button(QMessageBox::Yes)->setText(tr("&Replace"));
  return box.exec() == QMessageBox::Yes;
}

void MainWindow::closeEvent(QCloseEvent* event) {
  event->ignore();
  const bool is_baking = planner_.levels().is_baking();
  if (planner_.job().is_running() || is_baking) {
    const BackgroundJob& running = planner_.job().is_running() ? planner_.job() : planner_.levels().job();
    QMessageBox box(QMessageBox::Question, tr("SpinalTap planner"), tr("%1 is still running.").arg(running.what()),
                    QMessageBox::NoButton, this);
    box.setObjectName("running");
    box.setInformativeText(
        tr("No file is left half written, and a bake goes on next time from the stages that are finished."));
    QPushButton* stop = box.addButton(tr("Stop it and close"), QMessageBox::DestructiveRole);
    box.addButton(tr("Keep the window open"), QMessageBox::RejectRole);
    box.exec();
    if (box.clickedButton() != stop) return;
    planner_.cancel();
    planner_.levels().cancel();
    if (planner_.player().has_unsaved()) planner_.job().wait();  // saving the record takes its place
  }
  if (!may_lose_work([this] { close(); })) return;
  planner_.player().stop();
  QSettings settings;
  settings.setValue("geometry", saveGeometry());
  settings.setValue("boneOpacity", planner_.view().bone_opacity());
  if (autosave_) autosave_->forget();
  event->accept();
}

bool MainWindow::offer_lost_work() {
  for (const LostWork& lost : lost_work()) {
    QMessageBox box(QMessageBox::Question, tr("SpinalTap planner"),
                    tr("The planner ended without being closed. Bring back what was not saved?"), QMessageBox::NoButton,
                    this);
    box.setObjectName("lostWork");
    QString what = tr("%n path(s)", nullptr, static_cast<int>(lost.paths.size()));
    if (!lost.holes.empty()) what += tr(" and %n drilled hole(s)", nullptr, static_cast<int>(lost.holes.size()));
    box.setInformativeText(
        tr("%1, last changed %2.").arg(what, QLocale().toString(lost.changed, QLocale::ShortFormat)));
    QPushButton* yes = box.addButton(tr("&Bring back"), QMessageBox::AcceptRole);
    QPushButton* no = box.addButton(tr("&Discard"), QMessageBox::DestructiveRole);
    QPushButton* later = box.addButton(tr("&Later"), QMessageBox::RejectRole);
    box.setDefaultButton(yes);
    box.setEscapeButton(later);
    box.exec();
    if (box.clickedButton() == no) remove_lost_work(lost);
    if (box.clickedButton() != yes) continue;
    bring_back(lost);
    return true;
  }
  return false;
}

/// Opens the bone that the work is for, where it is among the recent files; take_back() does the rest.
void MainWindow::bring_back(const LostWork& lost) {
  lost_ = lost;
  for (const QString& file : QSettings().value("recent").toStringList()) {
    if (fingerprint_of_name(file.toStdString()) != lost.file || !QFileInfo::exists(file)) continue;
    open(file.toStdString(), lost.options);
    return;
  }
  tell(tr("The bone that the plan was made for is not among the recent files."),
       tr("Open it, and the plan comes back. Until then it is kept."));
}

/// Puts lost work onto the bone that was opened, where that is its own.
void MainWindow::take_back() {
  const std::shared_ptr<const OpenedBone> bone = planner_.document().bone();
  if (!lost_ || !bone) return;
  // Another build may bake another bone of the same CT, in the same place.
  const bool is_opened_alike =
      fingerprint_of_name(bone->file) == lost_->file && bone->options.level == lost_->options.level &&
      bone->options.seed_mm == lost_->options.seed_mm && bone->options.reading.series == lost_->options.reading.series;
  if (bone->bone->hash() != lost_->bone && !is_opened_alike) return;
  const LostWork lost = *std::exchange(lost_, std::nullopt);
  attempt(tr("Cannot bring the plan back"), [&] {
    planner_.document().add_paths(lost.paths, tr("bring back"));
    if (lost.chosen >= 0 && lost.chosen < static_cast<int>(planner_.document().paths().size())) {
      planner_.document().choose(lost.chosen);
    }
    planner_.player().drill_again(lost.holes);
    if (autosave_) autosave_->keep(lost.holes);
    remove_lost_work(lost);
    statusBar()->showMessage(tr("Brought back what was not saved"), 8000);
  });
}

}  // namespace spinaltap
