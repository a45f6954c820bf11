#pragma once

#include <QMainWindow>
#include <QTimer>
#include <filesystem>
#include <map>
#include <optional>

#include "apps/spinaltap-planner/planner.h"

class QAction;
class QLabel;
class QMenu;
class QProgressBar;
class QTabWidget;
class QToolButton;

namespace spinaltap {

class DrillPanel;
class FiguresPanel;
class FourPanes;
class PathPanel;
class SliceView;

/// The planner's window: four panes, the paths and their figures, drilling. Guards what is not saved.
class MainWindow : public QMainWindow {
  Q_OBJECT
 public:
  /// Throws Error where a shipped file is missing or damaged.
  MainWindow();
  ~MainWindow() override;

  Planner& planner() { return planner_; }
  FourPanes& panes() { return *panes_; }

  /// As Planner::open(), but asks first where a plan would be lost, and which bone of several is meant where `level`
  /// does not say it, and shows what is wrong in a box.
  void open(const std::filesystem::path& path, Level level = Level::kNone);
  /// A picture of the window, or of one of its panes: "axial", "coronal", "sagittal", "3d", "path". Throws Error on
  /// other names, and where the file cannot be written.
  void save_picture(const std::filesystem::path& file, const QString& pane = {});
  /// Shows the page with paths and figures, or the one with drilling.
  void show_page(const QString& name);
  /// Everything that was asked for has been drawn.
  void settle();

 protected:
  void closeEvent(QCloseEvent* event) override;
  void dragEnterEvent(QDragEnterEvent* event) override;
  void dropEvent(QDropEvent* event) override;

 private:
  /// Which bone of a file of several; nothing where the person does not want any.
  std::optional<Level> ask_level(const std::filesystem::path& path);
  void make_pages();
  void make_menus();
  void make_file_menu();
  void make_edit_menu();
  void make_view_menu();
  void make_status_bar();
  void connect_player();
  QAction* add_action(QMenu* menu, const QString& text, const QKeySequence& keys, const char* name,
                      std::function<void()> work);
  /// For what is on or off in 3D: follows the view as well as it changes it.
  void add_toggle(QMenu* menu, const QString& text, const QKeySequence& keys, const QString& name,
                  const std::function<bool(const ViewState&)>& is_on,
                  const std::function<void(ViewState&, bool)>& turn);

  /// Runs what may throw; shows what went wrong in a box.
  void attempt(const QString& what, const std::function<void()>& work);
  void tell(const QString& what, const QString& why);
  /// Whether the plan may be lost: saved, or the person said so.
  bool may_lose_plan();
  bool save_plan();
  bool save_plan_as();
  void ask_and_save(const QString& title, const QString& name, const QString& filter,
                    const std::function<void(const std::filesystem::path&)>& save);
  void add_path_here();
  void update_figures();
  void show_figures();
  void update_actions();
  void update_title();
  void update_hover();
  void note_recent(const QString& file);
  void fill_recent();

  Planner planner_;
  FourPanes* panes_ = nullptr;
  SliceView* down_path_ = nullptr;
  QTabWidget* pages_ = nullptr;
  PathPanel* paths_ = nullptr;
  FiguresPanel* figures_ = nullptr;
  DrillPanel* drill_ = nullptr;
  QMenu* recent_ = nullptr;
  QLabel* hover_ = nullptr;
  QLabel* working_ = nullptr;
  QProgressBar* progress_ = nullptr;
  QToolButton* cancel_ = nullptr;
  std::map<QString, QAction*> actions_;
  QTimer figures_due_;
};

}  // namespace spinaltap
