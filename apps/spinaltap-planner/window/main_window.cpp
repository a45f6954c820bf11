#include "apps/spinaltap-planner/window/main_window.h"

#include <QApplication>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QLabel>
#include <QMenuBar>
#include <QMessageBox>
#include <QMimeData>
#include <QScrollArea>
#include <QSettings>
#include <QStatusBar>
#include <QTabWidget>
#include <QTimer>
#include <QVBoxLayout>
#include <algorithm>
#include <utility>

#include "apps/spinaltap-planner/drill/drill_panel.h"
#include "apps/spinaltap-planner/figures/figures_panel.h"
#include "apps/spinaltap-planner/navigation/navigation_panel.h"
#include "apps/spinaltap-planner/scene/scene_view.h"
#include "apps/spinaltap-planner/slices/slice_view.h"
#include "apps/spinaltap-planner/window/four_panes.h"
#include "apps/spinaltap-planner/window/job_bar.h"
#include "apps/spinaltap-planner/window/levels_panel.h"
#include "apps/spinaltap-planner/window/path_panel.h"
#include "apps/spinaltap-planner/window/wheel_needs_focus.h"
#include "apps/spinaltap-planner/window/words.h"
#include "core/base/error.h"

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
  new WheelNeedsFocus(this);  // the window's child
  setAcceptDrops(true);
  setDockOptions(AnimatedDocks);
  panes_ = new FourPanes(planner_.document(), planner_.view());
  setCentralWidget(panes_);
  make_pages();
  make_menus();
  make_status_bar();
  connect_player();
  connect_questions();
  autosave_ = std::make_unique<Autosave>(planner_);

  figures_due_.setSingleShot(true);
  connect(&figures_due_, &QTimer::timeout, this, &MainWindow::show_figures);
  PlanDocument& document = planner_.document();
  connect(&document, &PlanDocument::bone_changed, this, &MainWindow::update_figures);
  connect(&document, &PlanDocument::paths_changed, this, &MainWindow::update_figures);
  connect(&document, &PlanDocument::chosen_changed, this, &MainWindow::update_figures);
  connect(&document.undo_stack(), &QUndoStack::cleanChanged, this, &MainWindow::update_title);
  connect(&document, &PlanDocument::paths_changed, this, &MainWindow::update_title);
  connect(&planner_, &Planner::opened, this, &MainWindow::show_opened);
  connect(&planner_.levels(), &CtLevels::changed, this, &MainWindow::update_actions);
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
  autosave_.reset();
  // What draws goes before what it draws, and nobody listens to threads that end.
  for (QObject* speaker :
       {static_cast<QObject*>(&planner_), static_cast<QObject*>(&planner_.player()),
        static_cast<QObject*>(&planner_.job()), static_cast<QObject*>(&planner_.levels()),
        static_cast<QObject*>(&planner_.levels().job()), static_cast<QObject*>(&planner_.document()),
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
  navigation_ = new NavigationPanel(planner_.document(), planner_.view(), planner_.player());

  levels_ = new LevelsPanel(planner_.levels(), planner_.document());
  connect(levels_, &LevelsPanel::wanted, this, &MainWindow::look_at_level);
  connect(levels_, &LevelsPanel::all_wanted, this, [this] { planner_.bake_all(); });

  pages_ = new QTabWidget;
  pages_->setObjectName("pages");
  pages_->addTab(levels_, tr("&CT"));
  pages_->addTab(scrolled(plan), tr("&Plan"));
  pages_->addTab(down_path_, tr("Down the p&ath"));
  pages_->addTab(scrolled(drill_), tr("D&rill"));
  pages_->addTab(scrolled(navigation_), tr("&Navigate"));
  auto* dock = new QDockWidget(tr("Paths and drilling"));
  dock->setObjectName("dock");
  dock->setFeatures(QDockWidget::DockWidgetMovable);
  dock->setTitleBarWidget(new QWidget);  // the tabs say enough
  dock->setWidget(pages_);
  pages_->setMinimumWidth(kPageWidth);
  show_page("plan");
  addDockWidget(Qt::RightDockWidgetArea, dock);
}

void MainWindow::make_status_bar() {
  // Permanent parts stay where messages come and go; the message has what they leave.
  BackgroundJob& job = planner_.job();
  statusBar()->addPermanentWidget(
      new JobBar(planner_.levels().job(), "levels", [this] { planner_.levels().cancel(); }));
  statusBar()->addPermanentWidget(new JobBar(job, "", [this] { planner_.cancel(); }));
  hover_ = new QLabel;
  hover_->setObjectName("hover");
  // Buttons beside it stay where they are while a pointer is on its way to them.
  hover_->setMinimumWidth(fontMetrics().horizontalAdvance(tr("R 000.0  A 000.0  I 0000.0 mm   -1000 HU")));
  statusBar()->addPermanentWidget(hover_);
  connect(&job, &BackgroundJob::started, this, &MainWindow::update_actions);
  connect(&job, &BackgroundJob::finished, this, [this](bool is_done, const QString& why) {
    if (!is_done && why.isEmpty()) statusBar()->showMessage(tr("%1: cancelled").arg(planner_.job().what()), 8000);
    if (!planner_.is_to_open()) given_up_.reset();
    const std::function<void()> after = std::exchange(after_job_, nullptr);
    if (is_done && after) QTimer::singleShot(0, this, after);
    update_actions();
  });
  shown_ = new QLabel;
  shown_->setObjectName("shown");
  shown_->setContentsMargins(0, 0, 8, 0);
  menuBar()->setCornerWidget(shown_);
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
  connect(navigation_, &NavigationPanel::failed, this, [this](const QString& why) { tell(tr("Navigation"), why); });
  connect(drill_, &DrillPanel::milling_wanted, this, &MainWindow::choose_milling);
  connect(drill_, &DrillPanel::save_record_wanted, this, &MainWindow::save_record);
  connect(drill_, &DrillPanel::write_report_wanted, this, &MainWindow::write_drill_report);
}

bool MainWindow::attempt(const QString& what, const std::function<void()>& work) {
  try {
    work();
    return true;
  } catch (const std::exception& error) {
    tell(what, QString::fromUtf8(error.what()));
  }
  return false;
}

void MainWindow::tell(const QString& what, const QString& why) {
  QMessageBox box(QMessageBox::Warning, tr("SpinalTap planner"), what, QMessageBox::Ok, this);
  box.setObjectName("trouble");
  box.setInformativeText(why);
  box.setTextInteractionFlags(Qt::TextSelectableByMouse);
  box.exec();
}

void MainWindow::show_page(const QString& name) {
  const QStringList names{"ct", "plan", "path", "drill", "navigate"};
  const auto index = static_cast<int>(names.indexOf(name));
  if (index < 0) fail("expected the page ct, plan, path, drill or navigate, found \"", name.toStdString(), "\"");
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

void MainWindow::show_level(int index) {
  const auto bone_of = [this, index]() -> std::shared_ptr<const OpenedBone> {
    const std::vector<CtLevel>& levels = planner_.levels().levels();
    return index < static_cast<int>(levels.size()) ? levels[static_cast<std::size_t>(index)].bone : nullptr;
  };
  const std::shared_ptr<const OpenedBone> bone = bone_of();
  if (!bone) return planner_.show_level(index);
  if (bone == planner_.document().bone()) return;
  // The question takes its time: another CT may have come.
  if (may_lose_work([this, index] { show_level(index); }) && bone == bone_of()) planner_.show_level(index);
}

void MainWindow::look_at_level(int index) {
  const CtLevel& level = planner_.levels().levels()[static_cast<std::size_t>(index)];
  planner_.put_crosshair(level.report.body_centre_mm);
  panes_->fit_slices_to(level.box_mm());
  show_level(index);
}

void MainWindow::show_opened(const QString& file) {
  note_recent(file);
  update_title();
  update_actions();
  const bool is_on_levels = pages_->currentWidget() == levels_;
  if (!planner_.document().bone()) {
    show_page("ct");
  } else if (is_on_levels && !planner_.levels().is_baking()) {
    show_page("plan");
  }
}

void MainWindow::update_title() {
  const PlanDocument& document = planner_.document();
  const std::filesystem::path& file = planner_.plan_file();
  const QString plan = file.empty() ? tr("New plan") : text_of(file.filename().string());
  setWindowTitle(plan + "[*] - SpinalTap planner");
  setWindowModified(planner_.has_unsaved_changes());
  QStringList shown;
  if (document.opened()) {
    std::filesystem::path opened = document.opened()->file;
    if (!opened.has_filename()) opened = opened.parent_path();
    constexpr int kMaxNamePx = 240;
    const QString name =
        shown_->fontMetrics().elidedText(text_of(opened.filename().string()), Qt::ElideMiddle, kMaxNamePx);
    shown += document.opened()->is_whole_ct ? tr("CT %1").arg(name) : name;
    const int index = planner_.levels().of(document.bone().get());
    if (!document.bone()) {
      shown += tr("no vertebra yet");
    } else if (index >= 0) {
      shown += planner_.levels().levels()[static_cast<std::size_t>(index)].name();
    } else {
      const Level level = document.bone()->bone->level();
      shown += level == Level::kNone ? tr("level not known") : text_of(level_name(level));
    }
  }
  if (!document.paths().empty() || !file.empty()) {
    const QString short_plan = shown_->fontMetrics().elidedText(plan, Qt::ElideMiddle, 180);
    shown += tr("%1, %2").arg(file.empty() ? tr("new plan") : short_plan,
                              planner_.has_unsaved_changes() ? tr("NOT SAVED") : tr("saved"));
  }
  shown_->hide();  // the menu's line measures it when it is shown
  shown_->setText(shown.join("   |   "));
  shown_->show();
}

void MainWindow::update_hover() {
  const std::optional<Vec3>& p = planner_.view().hovered_mm();
  if (!p || !planner_.document().opened()) {
    hover_->clear();
    return;
  }
  const auto axis = [](double value, const char* plus, const char* minus) {
    return QString("%1 %2").arg(QLatin1String(value < 0.0 ? minus : plus)).arg(std::abs(value), 0, 'f', 1);
  };
  hover_->setText(tr("%1  %2  %3 mm   %4 HU")
                      .arg(axis(p->x(), "L", "R"), axis(p->y(), "P", "A"), axis(p->z(), "S", "I"))
                      .arg(sample_hu(planner_.document().opened()->ct, *p), 0, 'f', 0));
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
