#include <QAction>
#include <QActionGroup>
#include <QApplication>
#include <QFileInfo>
#include <QLabel>
#include <QMenuBar>
#include <QMessageBox>
#include <QSettings>
#include <QSlider>
#include <QWidgetAction>
#include <array>

#include "apps/spinaltap-planner/drill/drill_panel.h"
#include "apps/spinaltap-planner/scene/scene_view.h"
#include "apps/spinaltap-planner/window/four_panes.h"
#include "apps/spinaltap-planner/window/main_window.h"
#include "apps/spinaltap-planner/window/path_panel.h"
#include "apps/spinaltap-planner/window/words.h"
#include "core/base/version.h"

namespace spinaltap {
namespace {

constexpr int kMaxRecent = 8;

struct WindowPreset {
  const char* name;
  HuWindow window;
};
constexpr std::array<WindowPreset, 4> kWindowPresets{{{"Bone", {1800.0, 500.0}},
                                                      {"Bone, wide", {3000.0, 700.0}},
                                                      {"Cancellous bone", {800.0, 250.0}},
                                                      {"Soft tissue", {400.0, 40.0}}}};

}  // namespace

QAction* MainWindow::add_action(QMenu* menu, const QString& text, const QKeySequence& keys, const char* name,
                                std::function<void()> work) {
  QAction* action = menu->addAction(text);
  action->setShortcut(keys);
  action->setObjectName(QString::fromLatin1(name));
  connect(action, &QAction::triggered, this, [work = std::move(work)] { work(); });
  actions_[action->objectName()] = action;
  return action;
}

void MainWindow::add_toggle(QMenu* menu, const QString& text, const QKeySequence& keys, const QString& name,
                            const std::function<bool(const ViewState&)>& is_on,
                            const std::function<void(ViewState&, bool)>& turn) {
  QAction* action = menu->addAction(text);
  action->setShortcut(keys);
  action->setObjectName(name);
  action->setCheckable(true);
  ViewState& state = planner_.view();
  action->setChecked(is_on(state));
  connect(action, &QAction::toggled, this, [&state, turn](bool on) { turn(state, on); });
  connect(&state, &ViewState::scene_changed, action, [action, &state, is_on] { action->setChecked(is_on(state)); });
}

void MainWindow::make_menus() {
  make_file_menu();
  make_edit_menu();
  make_view_menu();
  QMenu* drilling = menuBar()->addMenu(tr("Dri&lling"));
  for (QAction* action : drill_->drilling_actions()) drilling->addAction(action);
  QMenu* help = menuBar()->addMenu(tr("&Help"));
  add_action(help, tr("&Mouse and keys"), QKeySequence::HelpContents, "help", [this] {
    QMessageBox box(this);
    box.setObjectName("keys");
    box.setWindowTitle(tr("Mouse and keys"));
    box.setTextFormat(Qt::RichText);
    box.setText(
        tr("<h3>Slices</h3>"
           "Wheel, Page Up, Page Down: next slice (Shift: ten)<br>"
           "Left button: crosshair; on an end of a path: move it<br>"
           "Right button: brightness and contrast<br>"
           "Middle button, or Shift and left: move the picture; Ctrl and wheel, + and -: zoom; 0: fit<br>"
           "Ctrl and arrows: nudge the entry; Alt and arrows: the target; with Shift ten times as far<br>"
           "<h3>3D</h3>"
           "Left button: turn; on an end of a path: move it. Middle: move. Wheel: zoom<br>"
           "1 to 6: from behind, front, left, right, above, below; 7: towards the hole; R: all of it<br>"
           "Double click: crosshair there. Ctrl+T: bone see-through; Ctrl+H: without bits and screws<br>"
           "<h3>The page Plan</h3>"
           "In the list of paths: a new name, typed. Delete: remove the path<br>"
           "<h3>Drilling, on every page</h3>"
           "F6: drill; F7: stop, go on; F8: back 1 s; F9, Shift+F9: undo, redo the hole<br>"
           "<h3>Everywhere</h3>"
           "F1: this help. Tab: next pane. F2 to F5: one pane alone; F12: all four. Escape: put back what is being "
           "moved"));
    box.exec();
  });
  add_action(help, tr("&About"), {}, "about", [this] {
    QMessageBox::about(this, tr("About"),
                       tr("<b>SpinalTap planner %1</b><p>Plans and drills paths through a vertebra.<p>Research and "
                          "training software, not a medical device: a person must judge what it shows.")
                           .arg(QString::fromLatin1(version())));
  });
}

void MainWindow::make_edit_menu() {
  QMenu* edit = menuBar()->addMenu(tr("&Edit"));
  QUndoStack& stack = planner_.document().undo_stack();
  QAction* undo = stack.createUndoAction(this, tr("&Undo"));
  undo->setShortcut(QKeySequence::Undo);
  QAction* redo = stack.createRedoAction(this, tr("&Redo"));
  redo->setShortcuts({QKeySequence("Ctrl+Shift+Z"), QKeySequence("Ctrl+Y")});
  edit->addAction(undo);
  edit->addAction(redo);
  edit->addSeparator();
  QAction* suggest = add_action(edit, tr("&Suggest paths"), QKeySequence("Ctrl+G"), "suggest",
                                [this] { attempt(tr("Cannot suggest paths"), [this] { planner_.suggest(); }); });
  QAction* add = add_action(edit, tr("&Add path"), QKeySequence("Ctrl+N"), "add",
                            [this] { attempt(tr("Cannot add a path here"), [this] { add_path_here(); }); });
  add->setToolTip(tr("From the back of the bone straight to the crosshair"));
  QAction* remove = add_action(edit, tr("Re&move path"), QKeySequence("Ctrl+Backspace"), "remove", [this] {
    attempt(tr("Cannot remove the path"), [this] { planner_.document().remove_path(planner_.document().chosen()); });
  });
  remove->setShortcuts({QKeySequence::Delete, QKeySequence("Ctrl+Backspace")});
  add_action(edit, tr("&Next path"), QKeySequence("Ctrl+E"), "next", [this] {
    PlanDocument& document = planner_.document();
    if (document.chosen() >= 0) document.choose((document.chosen() + 1) % static_cast<int>(document.paths().size()));
  });
  suggest->setIconText(tr("Suggest"));
  add->setIconText(tr("Add"));
  remove->setIconText(tr("Remove"));
  paths_->set_actions({suggest, add, remove});
}

void MainWindow::make_view_menu() {
  QMenu* view = menuBar()->addMenu(tr("&View"));
  QMenu* window = view->addMenu(tr("&HU window"));
  int key = 1;
  for (const WindowPreset& preset : kWindowPresets) {
    const QString name = tr("%1 (%2 wide, %3 middle)")
                             .arg(QLatin1String(preset.name))
                             .arg(preset.window.width_hu, 0, 'f', 0)
                             .arg(preset.window.level_hu, 0, 'f', 0);
    add_action(window, name, QKeySequence(QString("Ctrl+%1").arg(key++)), preset.name,
               [this, preset] { planner_.view().set_window(preset.window); });
  }
  QMenu* guides = view->addMenu(tr("&Slices in 3D"));
  const std::array<std::pair<Plane, QString>, 3> planes{
      {{Plane::kAxial, tr("&Axial")}, {Plane::kCoronal, tr("&Coronal")}, {Plane::kSagittal, tr("&Sagittal")}}};
  for (const auto& [plane, name] : planes) {
    add_toggle(
        guides, name, {}, "guide" + QString(name).remove('&'),
        [plane = plane](const ViewState& state) { return state.shows_guide(plane); },
        [plane = plane](ViewState& state, bool on) { state.show_guide(plane, on); });
  }
  add_toggle(view, tr("Bits and scre&ws in 3D"), QKeySequence("Ctrl+H"), "tools", &ViewState::shows_tools,
             &ViewState::show_tools);
  QAction* levels = view->addAction(tr("&Levels on the slices"));
  levels->setShortcut(QKeySequence("Ctrl+L"));
  levels->setObjectName("showLevels");
  levels->setCheckable(true);
  levels->setChecked(planner_.view().shows_levels());
  connect(levels, &QAction::toggled, this, [this](bool on) { planner_.view().show_levels(on); });
  auto* opacity = new QSlider(Qt::Horizontal);
  opacity->setObjectName("opacity");
  opacity->setRange(0, 100);
  opacity->setMinimumWidth(160);
  auto* bone = new QWidgetAction(this);
  bone->setDefaultWidget(opacity);
  QMenu* opacities = view->addMenu(tr("&Bone's opacity"));
  opacities->addAction(bone);
  connect(opacity, &QSlider::valueChanged, this,
          [this](int percent) { planner_.view().set_bone_opacity(0.01 * percent); });
  connect(&planner_.view(), &ViewState::scene_changed, opacity, [this, opacity] {
    const QSignalBlocker quiet(opacity);
    opacity->setValue(static_cast<int>(std::lround(100.0 * planner_.view().bone_opacity())));
  });
  add_action(opacities, tr("&Solid or see-through"), QKeySequence("Ctrl+T"), "seeThrough",
             [this] { planner_.view().set_bone_opacity(planner_.view().bone_opacity() < 1.0 ? 1.0 : 0.35); });
  QMenu* from = view->addMenu(tr("3D &from"));
  for (const char* name : {"behind", "front", "left", "right", "above", "below", "hole"}) {
    add_action(from, tr(name), {}, name,
               [this, name] { attempt(tr("Cannot look from there"), [&] { panes_->scene().look_from(name); }); });
  }
  view->addSeparator();
  int pane_key = Qt::Key_F2;
  for (const char* name : {"axial", "coronal", "sagittal", "3d"}) {
    const QString object = QString("only%1").arg(name);
    add_action(view, tr("Only %1").arg(QLatin1String(name)), QKeySequence(pane_key++), object.toLatin1().constData(),
               [this, name] { panes_->show_only(name); });
  }
  add_action(view, tr("All &four panes"), QKeySequence(Qt::Key_F12), "fourPanes", [this] { panes_->show_only({}); });
  add_action(view, tr("Full screen"), QKeySequence(Qt::Key_F11), "fullScreen",
             [this] { setWindowState(windowState() ^ Qt::WindowFullScreen); });
}

void MainWindow::note_recent(const QString& file) {
  QSettings settings;
  QStringList recent = settings.value("recent").toStringList();
  const QString whole = QFileInfo(file).absoluteFilePath();
  recent.removeAll(whole);
  recent.prepend(whole);
  settings.setValue("recent", QStringList(recent.mid(0, kMaxRecent)));
}

void MainWindow::fill_recent() {
  recent_->clear();
  for (const QString& file : QSettings().value("recent").toStringList()) {
    QAction* action = recent_->addAction(file);
    action->setEnabled(QFileInfo::exists(file));
    connect(action, &QAction::triggered, this, [this, file] { open(file.toStdString()); });
  }
  recent_->setEnabled(!recent_->isEmpty());
}

void MainWindow::update_actions() {
  const PlanDocument& document = planner_.document();
  const bool has_bone = document.bone() != nullptr, has_path = document.chosen() >= 0;
  const bool is_free = !planner_.job().is_running();
  for (const char* name : {"saveBone", "add"}) actions_[name]->setEnabled(has_bone);
  actions_["bakeHere"]->setEnabled(document.opened() && document.opened()->is_whole_ct);
  actions_["suggest"]->setEnabled(has_bone && is_free);
  for (const char* name : {"save", "saveAs", "exportMarkups", "report", "remove", "next", "hole"}) {
    actions_[name]->setEnabled(has_bone && has_path);
  }
}

}  // namespace spinaltap
