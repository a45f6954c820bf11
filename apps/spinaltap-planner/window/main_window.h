#pragma once

#include <QMainWindow>
#include <QTimer>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "apps/spinaltap-planner/autosave.h"
#include "apps/spinaltap-planner/planner.h"

class QAction;
class QLabel;
class QMenu;
class QTabWidget;

namespace spinaltap {

class DrillPanel;
class ElidedLabel;
class FiguresPanel;
class FourPanes;
class LevelsPanel;
class NavigationPanel;
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
  NavigationPanel& navigation() { return *navigation_; }

  /// As Planner::open(), but asks first where a plan or a drilling would be lost, and which bone of several is meant
  /// where the options do not say it, and shows what is wrong in a box.
  void open(const std::filesystem::path& path, const OpenOptions& options = {});
  /// Offers the plans that crashed windows left behind (autosave.h), one after the other, until one is to be brought
  /// back; false: none is.
  bool offer_lost_work();
  /// Nobody sits at the window: no question is asked, nothing is kept for after a crash.
  void run_alone();
  /// A picture of the window, or of one of its panes: "axial", "coronal", "sagittal", "3d", "path". Throws Error on
  /// other names, and where the file cannot be written.
  void save_picture(const std::filesystem::path& file, const QString& pane = {});
  /// Shows a page: "ct", "plan", "path", "drill", "navigate".
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

  /// Runs what may throw; shows what went wrong in a box. False: something did.
  bool attempt(const QString& what, const std::function<void()>& work);
  void tell(const QString& what, const QString& why);
  // main_window_guard.cpp
  /// Plan and drilling as they are: another value, other work.
  struct Work {
    std::uint64_t plan_revision = 0;
    DrillPlayer::Progresses holes;
    bool operator==(const Work&) const = default;
  };
  Work current_work() { return {planner_.document().revision(), planner_.player().progresses()}; }
  /// Whether the plan may be lost: saved, or the person said so.
  bool may_lose_plan();
  /// The same of plan and drilling. A drilling takes a while to be saved: then it is false, and `again`, which asks
  /// again, is called when that is done.
  bool may_lose_work(const std::function<void()>& again);
  bool may_lose_drilling(const std::function<void()>& again);
  void offer_what_opened(const std::function<void()>& show);
  void connect_questions();
  void ask_series(const std::filesystem::path& path, OpenOptions options, const SeveralSeries& several);
  void ask_plan(const std::filesystem::path& file, const QString& why, const std::function<void()>& take);
  void ask_resampling(const std::filesystem::path& path, OpenOptions options, const UnevenSlices& uneven);
  void open_at_once(const std::filesystem::path& path, const OpenOptions& options);
  void bring_back(const LostWork& lost);
  void take_back();
  bool save_plan();
  bool save_plan_as();
  /// Whether it was saved, or is being saved. Asks before a file is replaced.
  bool ask_and_save(const QString& title, const QString& name, const QString& filter,
                    const std::function<void(const std::filesystem::path&)>& save);
  /// Asks whether a file, or files of a folder, may be replaced.
  bool may_replace(const QString& what, const QString& where);
  void choose_milling();
  bool save_record();
  void write_drill_report();
  void add_path_here();
  void update_figures();
  void show_figures();
  void update_actions();
  /// Asks first where it is baked and something would be lost.
  void show_level(int index);
  /// The same, with the slices on it.
  void look_at_level(int index);
  void show_opened(const QString& file);
  /// Which CT, level and plan the window shows, and whether the plan is saved: in its title and in the menu's line.
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
  NavigationPanel* navigation_ = nullptr;
  QMenu* recent_ = nullptr;
  LevelsPanel* levels_ = nullptr;
  QLabel* shown_ = nullptr;
  QLabel* hover_ = nullptr;
  std::map<QString, QAction*> actions_;
  std::optional<Work> given_up_;        ///< what the person said may go when the bone that is opened is there
  std::function<void()> after_job_;     ///< the next that ends well
  std::optional<LostWork> lost_;        ///< waits for its bone
  std::unique_ptr<Autosave> autosave_;  ///< last: it looks at the rest
  QTimer figures_due_;
};

}  // namespace spinaltap
