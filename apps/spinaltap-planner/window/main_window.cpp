#include "apps/spinaltap-planner/window/main_window.h"

#include <QApplication>
#include <QCloseEvent>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QFileDialog>
#include <QInputDialog>
#include <QLabel>
#include <QMessageBox>
#include <QMimeData>
#include <QProgressBar>
#include <QPushButton>
#include <QScrollArea>
#include <QSettings>
#include <QStatusBar>
#include <QTabWidget>
#include <QTimer>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>

#include "apps/spinaltap-planner/drill/drill_panel.h"
#include "apps/spinaltap-planner/figures/figures_panel.h"
#include "apps/spinaltap-planner/scene/scene_view.h"
#include "apps/spinaltap-planner/slices/slice_view.h"
#include "apps/spinaltap-planner/window/four_panes.h"
#include "apps/spinaltap-planner/window/path_panel.h"
#include "apps/spinaltap-planner/window/words.h"
#include "core/base/error.h"
#include "vdb/grid/spine_file.h"

namespace spinaltap {
namespace {

constexpr int kPageWidth = 372;

QWidget* scrolled(QWidget* page) {
  auto* area = new QScrollArea;
  area->setWidget(page);
  area->setWidgetResizable(true);
  area->setFrameShape(QFrame::NoFrame);
  area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  return area;
}

}  // namespace

MainWindow::MainWindow() {
  setObjectName("planner");
  setAcceptDrops(true);
  setDockOptions(AnimatedDocks);
  panes_ = new FourPanes(planner_.document(), planner_.view());
  setCentralWidget(panes_);
  make_pages();
  make_menus();
  make_status_bar();
  connect_player();

  figures_due_.setSingleShot(true);
  connect(&figures_due_, &QTimer::timeout, this, &MainWindow::show_figures);
  PlanDocument& document = planner_.document();
  connect(&document, &PlanDocument::bone_changed, this, &MainWindow::update_figures);
  connect(&document, &PlanDocument::paths_changed, this, &MainWindow::update_figures);
  connect(&document, &PlanDocument::chosen_changed, this, &MainWindow::update_figures);
  connect(&document.undo_stack(), &QUndoStack::cleanChanged, this, &MainWindow::update_title);
  connect(&planner_, &Planner::opened, this, [this](const QString& file) {
    note_recent(file);
    update_title();
    update_actions();
  });
  connect(&planner_, &Planner::said, this, [this](const QString& what) { statusBar()->showMessage(what, 8000); });
  connect(&planner_, &Planner::trouble, this, &MainWindow::tell);

  const QSettings settings;
  resize(1400, 900);
  restoreGeometry(settings.value("geometry").toByteArray());
  planner_.view().set_bone_opacity(settings.value("boneOpacity", 1.0).toDouble());
  update_title();
  show_figures();
}

MainWindow::~MainWindow() {
  // What draws goes before what it draws, and nobody listens to threads that end.
  for (QObject* speaker :
       {static_cast<QObject*>(&planner_), static_cast<QObject*>(&planner_.player()),
        static_cast<QObject*>(&planner_.job()), static_cast<QObject*>(&planner_.document()),
        static_cast<QObject*>(&planner_.view()), static_cast<QObject*>(&planner_.document().undo_stack())}) {
    speaker->disconnect(this);
  }
  delete panes_;
  delete pages_;
}

void MainWindow::make_pages() {
  auto* plan = new QWidget;
  auto* layout = new QVBoxLayout(plan);
  layout->setContentsMargins(0, 0, 0, 0);
  paths_ = new PathPanel(planner_.document());
  layout->addWidget(paths_);
  figures_ = new FiguresPanel;
  layout->addWidget(figures_, 1);

  down_path_ = new SliceView(SliceKind::down_path, planner_.document(), planner_.view());
  down_path_->setObjectName("path");
  drill_ = new DrillPanel(planner_.document(), planner_.player());

  pages_ = new QTabWidget;
  pages_->setObjectName("pages");
  pages_->addTab(scrolled(plan), tr("&Plan"));
  pages_->addTab(down_path_, tr("Down the p&ath"));
  pages_->addTab(scrolled(drill_), tr("D&rill"));
  auto* dock = new QDockWidget(tr("Paths and drilling"));
  dock->setObjectName("dock");
  dock->setFeatures(QDockWidget::DockWidgetMovable);
  dock->setTitleBarWidget(new QWidget);  // the tabs say enough
  dock->setWidget(pages_);
  pages_->setMinimumWidth(kPageWidth);
  addDockWidget(Qt::RightDockWidgetArea, dock);
}

void MainWindow::make_status_bar() {
  hover_ = new QLabel;
  hover_->setObjectName("hover");
  statusBar()->addPermanentWidget(hover_);
  working_ = new QLabel;
  progress_ = new QProgressBar;
  progress_->setObjectName("progress");
  progress_->setRange(0, 100);
  progress_->setFixedWidth(160);
  cancel_ = new QToolButton;
  cancel_->setObjectName("cancel");
  cancel_->setText(tr("Cancel"));
  cancel_->setFocusPolicy(Qt::StrongFocus);
  for (QWidget* part :
       {static_cast<QWidget*>(working_), static_cast<QWidget*>(progress_), static_cast<QWidget*>(cancel_)}) {
    statusBar()->addWidget(part);
    part->hide();
  }
  BackgroundJob& job = planner_.job();
  connect(cancel_, &QToolButton::clicked, this, [this] { planner_.job().cancel(); });
  connect(&job, &BackgroundJob::started, this, [this](const QString& what) {
    working_->setText(what);
    progress_->setValue(0);
    working_->show();
    progress_->show();
    cancel_->show();
    update_actions();
  });
  connect(&job, &BackgroundJob::progressed, this, [this](const QString& stage, double share) {
    working_->setText(planner_.job().what() + ": " + stage);
    progress_->setValue(static_cast<int>(100.0 * share));
  });
  connect(&job, &BackgroundJob::finished, this, [this](bool is_done, const QString& why) {
    working_->hide();
    progress_->hide();
    cancel_->hide();
    if (!is_done && why.isEmpty()) statusBar()->showMessage(tr("%1: cancelled").arg(planner_.job().what()), 8000);
    update_actions();
  });
  connect(&planner_.view(), &ViewState::hovered_changed, this, &MainWindow::update_hover);
  statusBar()->showMessage(tr("Research and training software, not a medical device"));
}

void MainWindow::connect_player() {
  DrillPlayer& player = planner_.player();
  connect(&player, &DrillPlayer::surface_changed, this, [this](const std::vector<SurfaceUpdate>& updates) {
    panes_->update_surface(updates);
    down_path_->update_surface(updates);
  });
  const auto show_bit = [this] {
    panes_->set_bit(planner_.player().bit());
    down_path_->set_bit(planner_.player().bit());
  };
  connect(&player, &DrillPlayer::progressed, this, show_bit);
  connect(&player, &DrillPlayer::state_changed, this, show_bit);
  connect(&player, &DrillPlayer::failed, this, [this](const QString& why) { tell(tr("Drilling"), why); });
  connect(drill_, &DrillPanel::save_record_wanted, this, [this] {
    ask_and_save(tr("Save the record"), "drilling.h5", tr("Records (*.h5)"),
                 [this](const std::filesystem::path& file) { planner_.save_record(file); });
  });
  connect(drill_, &DrillPanel::write_report_wanted, this, [this] {
    const QString folder = QFileDialog::getExistingDirectory(this, tr("Folder for the report on the drilling"));
    if (folder.isEmpty()) return;
    attempt(tr("Cannot write the report"), [&] { planner_.write_drill_report(folder.toStdString()); });
  });
}

void MainWindow::attempt(const QString& what, const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    tell(what, QString::fromUtf8(error.what()));
  }
}

void MainWindow::tell(const QString& what, const QString& why) {
  QMessageBox box(QMessageBox::Warning, tr("SpinalTap planner"), what, QMessageBox::Ok, this);
  box.setObjectName("trouble");
  box.setInformativeText(why);
  box.setTextInteractionFlags(Qt::TextSelectableByMouse);
  box.exec();
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

void MainWindow::open(const std::filesystem::path& path, Level level) {
  if (!may_lose_plan()) return;
  attempt(tr("Cannot open %1").arg(text_of(path.string())), [&] {
    const bool asks = level == Level::kNone && kind_of_file(path) == FileKind::bone;
    const std::optional<Level> chosen = asks ? ask_level(path) : level;
    if (chosen) planner_.open(path, *chosen);
  });
}

void MainWindow::show_page(const QString& name) {
  const QStringList names{"plan", "path", "drill"};
  const int index = names.indexOf(name);
  if (index < 0) fail("expected the page plan, path or drill, found \"", name.toStdString(), "\"");
  pages_->setCurrentIndex(index);
}

void MainWindow::settle() {
  // Drawing is put off twice at most: figures, then what they change.
  if (figures_due_.isActive()) show_figures();
  for (int round = 0; round < 3; ++round) {
    QApplication::processEvents();
    QApplication::sendPostedEvents();
  }
}

void MainWindow::update_figures() {
  // The panes first: they are what a hand that drags looks at.
  constexpr int kAfterPanesMs = 30;
  if (!figures_due_.isActive()) figures_due_.start(kAfterPanesMs);
}

void MainWindow::show_figures() {
  figures_due_.stop();
  const std::optional<PathFigures> figures = planner_.figures();
  const PathFigures* shown = figures ? &*figures : nullptr;
  paths_->show_figures(shown);
  figures_->show_figures(shown, planner_.grader().hu_bands());
  update_actions();
}

void MainWindow::update_title() {
  const std::filesystem::path& file = planner_.plan_file();
  const QString plan = file.empty() ? tr("New plan") : text_of(file.filename().string());
  setWindowTitle(plan + "[*] - SpinalTap planner");
  setWindowModified(planner_.has_unsaved_changes());
}

void MainWindow::update_hover() {
  const std::optional<Vec3>& p = planner_.view().hovered_mm();
  if (!p || !planner_.document().bone()) {
    hover_->clear();
    return;
  }
  const auto axis = [](double value, const char* plus, const char* minus) {
    return QString("%1 %2").arg(QLatin1String(value < 0.0 ? minus : plus)).arg(std::abs(value), 0, 'f', 1);
  };
  hover_->setText(tr("%1  %2  %3 mm   %4 HU")
                      .arg(axis(p->x(), "L", "R"), axis(p->y(), "P", "A"), axis(p->z(), "S", "I"))
                      .arg(sample_hu(planner_.document().bone()->ct, *p), 0, 'f', 0));
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

void MainWindow::closeEvent(QCloseEvent* event) {
  if (planner_.job().is_running()) {
    QMessageBox box(QMessageBox::Question, tr("SpinalTap planner"),
                    tr("%1 is still running.").arg(planner_.job().what()), QMessageBox::NoButton, this);
    box.setObjectName("running");
    box.setInformativeText(
        tr("No file is left half written, and a bake goes on next time from the stages that are finished."));
    QPushButton* stop = box.addButton(tr("Stop it and close"), QMessageBox::DestructiveRole);
    box.addButton(tr("Keep the window open"), QMessageBox::RejectRole);
    box.exec();
    if (box.clickedButton() != stop) {
      event->ignore();
      return;
    }
    planner_.job().cancel();
  }
  if (!may_lose_plan()) {
    event->ignore();
    return;
  }
  planner_.player().stop();
  QSettings settings;
  settings.setValue("geometry", saveGeometry());
  settings.setValue("boneOpacity", planner_.view().bone_opacity());
  event->accept();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
  const QList<QUrl> urls = event->mimeData()->urls();
  if (urls.size() == 1 && urls.front().isLocalFile()) event->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* event) {
  const QString file = event->mimeData()->urls().front().toLocalFile();
  event->acceptProposedAction();
  // Not from within the drop: the program that was dragged from waits for it.
  QTimer::singleShot(0, this, [this, file] { open(file.toStdString()); });
}

}  // namespace spinaltap
