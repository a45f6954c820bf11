#include <QFileDialog>
#include <QFileInfo>
#include <QMenuBar>
#include <QSettings>

#include "apps/spinaltap-planner/drill/drill_panel.h"
#include "apps/spinaltap-planner/drill/played_hole.h"
#include "apps/spinaltap-planner/scene/scene_view.h"
#include "apps/spinaltap-planner/slices/slice_view.h"
#include "apps/spinaltap-planner/window/four_panes.h"
#include "apps/spinaltap-planner/window/main_window.h"
#include "apps/spinaltap-planner/window/words.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/files/milling_file.h"

namespace spinaltap {
namespace {

QString last_folder() { return QSettings().value("folder").toString(); }

void keep_folder(const QString& file) { QSettings().setValue("folder", QFileInfo(file).absolutePath()); }

}  // namespace

void MainWindow::make_file_menu() {
  QMenu* file = menuBar()->addMenu(tr("&File"));
  add_action(file, tr("Open a CT &folder..."), QKeySequence("Ctrl+Shift+O"), "openFolder", [this] {
    const QString folder = QFileDialog::getExistingDirectory(this, tr("Folder of a CT"), last_folder());
    if (folder.isEmpty()) return;
    keep_folder(folder);
    open(folder.toStdString());
  });
  add_action(file, tr("&Open a bone, a plan or a CT file..."), QKeySequence::Open, "open", [this] {
    const QString name = QFileDialog::getOpenFileName(
        this, tr("A bone, a plan or a CT"), last_folder(),
        tr("All that can be opened (*.vdb *.json *.nii *.nii.gz *.nrrd *.nhdr *.mha *.mhd *.dcm);;All files (*)"));
    if (name.isEmpty()) return;
    keep_folder(name);
    open(name.toStdString());
  });
  add_action(file, tr("Bake the &vertebra at the crosshair"), QKeySequence("Ctrl+B"), "bakeHere",
             [this] { attempt(tr("Cannot bake here"), [this] { show_level(planner_.level_here()); }); });
  recent_ = file->addMenu(tr("&Recent"));
  connect(file, &QMenu::aboutToShow, this, &MainWindow::fill_recent);
  file->addSeparator();
  add_action(file, tr("&Save the plan"), QKeySequence::Save, "save", [this] { save_plan(); });
  add_action(file, tr("Save the plan &as..."), QKeySequence("Ctrl+Shift+S"), "saveAs", [this] { save_plan_as(); });
  add_action(file, tr("Export to 3D S&licer..."), {}, "exportMarkups", [this] {
    ask_and_save(tr("Export the paths as 3D Slicer's markups"), "plan.mrk.json", tr("Markups (*.mrk.json)"),
                 [this](const std::filesystem::path& path) { planner_.save_plan(path); });
  });
  add_action(file, tr("Save the &bone..."), {}, "saveBone", [this] {
    ask_and_save(tr("Save the baked bone"), "bone.vdb", tr("Bones (*.vdb)"),
                 [this](const std::filesystem::path& path) { planner_.save_bone(path); });
  });
  add_action(file, tr("Write a repor&t on the paths..."), {}, "report", [this] {
    ask_and_save(tr("Write the report on the paths"), "plan.html", tr("Reports (*.html)"),
                 [this](const std::filesystem::path& path) { planner_.save_report(path); });
  });
  QMenu* pictures = file->addMenu(tr("Save a &picture"));
  const std::pair<const char*, QString> panes[] = {{"", tr("Whole &window...")},   {"axial", tr("&Axial...")},
                                                   {"coronal", tr("&Coronal...")}, {"sagittal", tr("&Sagittal...")},
                                                   {"3d", tr("&3D...")},           {"path", tr("&Down the path...")}};
  for (const auto& [name, text] : panes) {
    const QString pane = QString::fromLatin1(name);
    add_action(pictures, text, {}, QString("picture" + pane).toLatin1().constData(), [this, pane] {
      ask_and_save(tr("Save a picture"), (pane.isEmpty() ? "window" : pane) + ".png", tr("Pictures (*.png)"),
                   [this, pane](const std::filesystem::path& path) { save_picture(path, pane); });
    });
  }
  file->addSeparator();
  add_action(file, tr("&Quit"), QKeySequence::Quit, "quit", [this] { close(); });
}

bool MainWindow::ask_and_save(const QString& title, const QString& name, const QString& filter,
                              const std::function<void(const std::filesystem::path&)>& save) {
  const QString folder = last_folder();
  const QString ending = name.mid(name.indexOf('.'));
  QString file = folder.isEmpty() ? name : folder + "/" + name;
  do {
    // The dialog does not know of the ending that is added: the question comes after that.
    file = QFileDialog::getSaveFileName(this, title, file, filter, nullptr, QFileDialog::DontConfirmOverwrite);
    if (file.isEmpty()) return false;
    if (!file.endsWith(ending, Qt::CaseInsensitive)) file += ending;
  } while (QFileInfo::exists(file) &&
           !may_replace(QFileInfo(file).fileName(), tr("A file of this name is there already.")));
  keep_folder(file);
  return attempt(tr("Cannot save %1").arg(file), [&] { save(file.toStdString()); });
}

bool MainWindow::save_plan() {
  if (planner_.plan_file().empty()) return save_plan_as();
  if (planner_.is_plan_file_foreign() && !may_replace(text_of(planner_.plan_file().filename().string()),
                                                      tr("Another program has changed this file since."))) {
    return false;
  }
  attempt(tr("Cannot save the plan"), [this] { planner_.save_plan(planner_.plan_file()); });
  return !planner_.has_unsaved_changes();
}

bool MainWindow::save_plan_as() {
  ask_and_save(tr("Save the plan"), "plan.json", tr("Plans (*.json)"), [this](const std::filesystem::path& path) {
    planner_.save_plan(path);
    note_recent(text_of(path.string()));
    update_title();
  });
  return !planner_.has_unsaved_changes();
}

void MainWindow::choose_milling() {
  const QString name =
      QFileDialog::getOpenFileName(this, tr("A milling"), last_folder(), tr("Millings (*.json);;All files (*)"));
  if (name.isEmpty()) return;
  keep_folder(name);
  attempt(tr("Cannot read the milling"), [&] { drill_->set_milling(read_milling(name.toStdString())); });
}

bool MainWindow::save_record() {
  return ask_and_save(tr("Save the record"), "drilling.h5", tr("Records (*.h5)"),
                      [this](const std::filesystem::path& file) { planner_.save_record(file); });
}

void MainWindow::write_drill_report() {
  const QString folder =
      QFileDialog::getExistingDirectory(this, tr("Folder for the report on the drilling"), last_folder());
  if (folder.isEmpty()) return;
  QStringList there;
  for (const char* name : kDrillReportFiles) {
    if (QFileInfo::exists(folder + "/" + name)) there += name;
  }
  if (!there.isEmpty() && !may_replace(there.join(", "), tr("They are in this folder already."))) return;
  attempt(tr("Cannot write the report"), [&] { planner_.write_drill_report(folder.toStdString()); });
}

void MainWindow::save_picture(const std::filesystem::path& file, const QString& pane) {
  QImage picture;
  if (pane.isEmpty()) {
    panes_->scene().picture();  // shows what it now has to
    picture = grab().toImage();
  } else if (pane == "3d") {
    picture = panes_->scene().picture();
  } else {
    QWidget* widget = pane == "path" ? down_path_ : panes_->pane(pane);
    if (widget == nullptr)
      fail("expected the pane axial, coronal, sagittal, 3d or path, found \"", pane.toStdString(), "\"");
    picture = widget->grab().toImage();
  }
  StagedOutput output;
  const std::filesystem::path staged = output.stage(file);
  if (!picture.save(text_of(staged.string()), "PNG"))
    fail_as(ErrorKind::disk, "cannot write ", file.string(), ": is the disk full?");
  output.commit();
}

void MainWindow::add_path_here() {
  PlanDocument& document = planner_.document();
  const Vec3& target_mm = planner_.view().crosshair_mm();
  DrillPath path;
  path.name = "path";
  path.target_mm = target_mm;
  path.entry_mm = entry_behind(*document.bone(), target_mm);
  path.bone = document.bone()->bone->identity();
  if (const DrillPath* chosen = document.chosen_path()) path.bit = chosen->bit;
  document.add_path(path);
}

}  // namespace spinaltap
