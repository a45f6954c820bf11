// Drives the planner's window at random, as a person would who presses everything: keys, mouse, files, cancels; and
// compares it with a model of the plan (plan_model.h). The same seed makes the same choices; threads and the clock do
// not repeat.
#include <QAbstractSpinBox>
#include <QApplication>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFileDialog>
#include <QInputDialog>
#include <QMessageBox>
#include <QPushButton>
#include <QSettings>
#include <QTableWidget>
#include <QToolButton>
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <sstream>

#include "apps/spinaltap-planner/autosave.h"
#include "apps/spinaltap-planner/scene/scene_view.h"
#include "apps/spinaltap-planner/slices/slice_view.h"
#include "apps/spinaltap-planner/window/four_panes.h"
#include "apps/spinaltap-planner/window/main_window.h"
#include "apps/spinaltap-planner/window/words.h"
#include "core/base/error.h"
#include "core/base/process_changes.h"
#include "core/base/staged_output.h"
#include "core/ct/dicom_write.h"
#include "core/files/plan_file.h"
#include "core/phantom/scanner.h"
#include "tests/gui/phantom_bone.h"
#include "tests/gui/random_tester/hang_watch.h"
#include "tests/gui/random_tester/plan_model.h"
#include "tests/gui/x_input.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap::test {
namespace {

namespace fs = std::filesystem;

struct TesterOptions {
  double seconds = 60.0;
  unsigned seed = 1;
  double max_hang_s = 2.0;
};

class RandomTester {
 public:
  explicit RandomTester(const TesterOptions& options) : options_(options), random_(options.seed) {
    make_files();  // bakes a bone
    deadlock_.emplace(kDeadlockS, [this] { tell("the window does not come back"); });
    QObject::connect(&answers_, &QTimer::timeout, &answers_, [this] {
      answers_.start(kAnswerMs);  // anew: Qt does not fire a timer within itself, and an answer may open another dialog
      answer();
    });
    answers_.start(kAnswerMs);
    open_window();
  }

  /// How many troubles were found.
  int run() {
    QElapsedTimer clock;
    clock.start();
    while (static_cast<double>(clock.elapsed()) < 1000.0 * options_.seconds && troubles_ < kMaxTroubles) {
      act();
      ++actions_;
    }
    stop_all();
    std::printf(
        "seed %u: %d actions in %.0f s, %d plans saved and read back, %d windows, longest hang %.2f s, %d troubles\n",
        options_.seed, actions_, 1e-3 * static_cast<double>(clock.elapsed()), saved_, windows_, longest_s_, troubles_);
    for (const auto& [name, count] : counts_) std::printf("  %-16s %d\n", name.c_str(), count);
    return troubles_;
  }

 private:
  static constexpr int kDeadlockS = 60;
  static constexpr int kAnswerMs = 40;
  static constexpr int kMaxTroubles = 10;
  static constexpr int kLateMs = 2000;  ///< within which a key must have done what it does

  int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  bool chance(double share) { return std::uniform_real_distribution<double>(0.0, 1.0)(random_) < share; }
  template <std::size_t N>
  const char* one_of(const std::array<const char*, N>& names) {
    return names[static_cast<std::size_t>(below(static_cast<int>(N)))];
  }
  Planner& planner() { return window_->planner(); }

  void make_files() {
    fs::copy_file(phantom_file(), folder_.path() / "bone.vdb");
    write_plan({phantom_paths()[1]}, folder_.path() / "other.mrk.json");
    write_whole_file(folder_.path() / "broken.json", "{\"format\": ");
    write_whole_file(folder_.path() / "broken.vdb", std::string(5000, 'x'));
    ScanOptions scanned;
    scanned.pixel_mm = 0.9;
    scanned.slice_step_mm = 2.0;
    scanned.columns = scanned.rows = 120;
    scanned.slices = 40;
    fs::create_directory(folder_.path() / "ct");
    write_dicom(scan(Vertebra(), scanned), folder_.path() / "ct");
    fs::copy(spine_folder(), folder_.path() / "spine");
    fs::create_directory(folder_.path() / "none");  // of DICOM files
  }

  void open_window() {
    write_plan(phantom_paths(), folder_.path() / "plan.json");  // what was saved there need not be for this bone
    window_ = std::make_unique<MainWindow>();
    window_->resize(1400, 900);
    input_.show(*window_);
    ++windows_;
    planner().open(folder_.path() / "bone.vdb");
    wait_until([&] { return planner().document().bone() != nullptr; }, 120000);
    planner().open(folder_.path() / "plan.json");
    let_work(200);
    model_.emplace(*window_);
  }

  void tell(const std::string& what) {
    const std::lock_guard lock(mutex_);
    std::fprintf(stderr, "seed %u, action %d: %s\n  last actions:", options_.seed, actions_, what.c_str());
    for (const std::string& one : last_) std::fprintf(stderr, " %s,", one.c_str());
    std::fprintf(stderr, "\n");
  }
  void trouble(const std::string& what) {
    tell(what);
    ++troubles_;
    model_->begin();  // one trouble is told once
  }
  void note(const std::string& what) {
    const std::lock_guard lock(mutex_);
    last_.push_back(what);
    if (last_.size() > 25) last_.pop_front();
  }

  /// Boxes and dialogs, at random: they hold up whoever opened them.
  void answer() {
    QWidget* dialog = QApplication::activeModalWidget();
    // A dialog that is being answered may open another, from within the key that answers it.
    if (std::find(answering_.begin(), answering_.end(), dialog) != answering_.end()) return;
    if (dialog == nullptr || !dialog->isVisible()) {
      answered_ = nullptr;
      return;
    }
    answering_.push_back(dialog);
    if (auto* box = qobject_cast<QMessageBox*>(dialog)) {
      answer_box(*box);
    } else if (qobject_cast<QFileDialog*>(dialog) != nullptr && dialog != answered_) {
      answered_ = dialog;
      const QString name = next_file_.isEmpty() ? random_file_to_save() : next_file_;
      next_file_.clear();
      if (chance(0.85)) {
        input_.key("ctrl+a");
        input_.type(name);
        input_.key("Return");
      } else {
        input_.key("Escape");
      }
    } else if (auto* choice = qobject_cast<QInputDialog*>(dialog); choice != nullptr && chance(0.7)) {
      choice->accept();
    } else {
      // No key: after a box of its own it has no keyboard, for want of a window manager.
      dialog->close();
    }
    answering_.pop_back();
  }

  void answer_box(QMessageBox& box) {
    const QList<QAbstractButton*> buttons = box.buttons();
    QAbstractButton* button = buttons[below(buttons.size())];
    note("[" + box.objectName().toStdString() + ": " + button->text().toStdString() + "]");
    if (box.objectName() == "trouble" && box.informativeText().contains("exception")) {
      tell("a box speaks of exceptions: " + box.informativeText().toStdString());
      ++troubles_;
    }
    if (box.objectName() == "unsaved" && box.standardButton(button) == QMessageBox::Discard) model_->give_up();
    button->click();
  }

  QString random_file_to_save() {
    static const std::array<const char*, 6> names{"saved",     "saved.json",  "second.json",
                                                  "plan.json", "none/x.json", "with blanks.json"};
    return text_of((folder_.path() / one_of(names)).string());
  }

  void act() {
    struct Action {
      const char* name;
      double weight;
      void (RandomTester::*run)();
    };
    static const std::array<Action, 18> actions{{{"undo", 8, &RandomTester::undo},
                                                 {"redo", 6, &RandomTester::redo},
                                                 {"nudge", 10, &RandomTester::nudge},
                                                 {"drag-end", 10, &RandomTester::drag_end},
                                                 {"mouse", 8, &RandomTester::mouse},
                                                 {"wheel", 5, &RandomTester::wheel},
                                                 {"key", 14, &RandomTester::key},
                                                 {"add", 6, &RandomTester::add},
                                                 {"remove", 4, &RandomTester::remove},
                                                 {"number", 6, &RandomTester::number},
                                                 {"rename", 4, &RandomTester::rename},
                                                 {"tool", 5, &RandomTester::tool},
                                                 {"suggest", 2, &RandomTester::suggest},
                                                 {"save", 4, &RandomTester::save},
                                                 {"open", 3, &RandomTester::open},
                                                 {"drill", 5, &RandomTester::drill},
                                                 {"level", 4, &RandomTester::level},
                                                 {"cancel", 3, &RandomTester::cancel}}};
    double total = 0.0;
    for (const Action& action : actions) total += action.weight;
    double at = std::uniform_real_distribution<double>(0.0, total)(random_);
    const Action* chosen = &actions.front();
    for (const Action& action : actions) {
      chosen = &action;
      if ((at -= action.weight) < 0.0) break;
    }
    note(chosen->name);
    ++counts_[chosen->name];
    effect_ = Effect::none;
    hangs_.take_longest();
    (this->*chosen->run)();
    settle();
    if (chance(0.01)) resize();
    if (chance(0.01)) close_window();
    const HangWatch::Standstill still = hangs_.take_longest();
    longest_s_ = std::max(longest_s_, still.longest_s);
    if (still.longest_s > options_.max_hang_s) {
      trouble("the window stood still for " + std::to_string(still.longest_s) + " s, of which it worked " +
              std::to_string(still.worked_s) + " s" + still.where);
    }
    check(effect_);
    if (chance(0.03)) {
      let_work(700);
      check(Effect::none);
      std::string wrong;
      wait_until([&] { return (wrong = model_->check_kept(work_folder())).empty(); }, kLateMs);
      if (!wrong.empty()) trouble(wrong);
    }
  }
  void check(Effect effect) {
    if (const std::string wrong = model_->check(effect); !wrong.empty()) trouble(wrong);
  }
  /// Boxes are answered, menus closed.
  void settle() {
    wait_until([] { return QApplication::activeModalWidget() == nullptr; }, 30000);
    while (QApplication::activePopupWidget() != nullptr) {
      QApplication::activePopupWidget()->close();
      let_work(20);
    }
    // There is no window manager to give the keyboard back.
    if (window_ && window_->isVisible() && !window_->isActiveWindow()) input_.show(*window_);
    let_work(15);
  }

  SliceView& random_slice() {
    static const std::array<const char*, 3> names{"axial", "coronal", "sagittal"};
    return dynamic_cast<SliceView&>(*window_->panes().pane(one_of(names)));
  }
  /// The keyboard leaves whatever box or list had it, for a pane that is seen: keys are the window's then.
  void focus_a_pane() {
    QWidgetList panes;
    for (const char* name : {"axial", "coronal", "sagittal", "3d"}) {
      if (QWidget* pane = window_->panes().pane(name); pane->isVisible()) panes.push_back(pane);
    }
    if (panes.empty()) fail("the window shows no pane");
    focus(*panes[below(panes.size())]);
  }
  void focus(QWidget& widget) {
    widget.setFocus(Qt::TabFocusReason);
    let_work(5);
  }
  QPoint random_place(QWidget& widget) {
    return {below(std::max(widget.width(), 1)), below(std::max(widget.height(), 1))};
  }

  void undo() {
    effect_ = Effect::undo;
    const QUndoStack& stack = planner().document().undo_stack();
    const int expected = std::max(stack.index() - 1, 0);
    focus_a_pane();
    input_.key("ctrl+z");
    wait_until([&] { return stack.index() == expected; }, kLateMs);
  }
  void redo() {
    effect_ = Effect::redo;
    const QUndoStack& stack = planner().document().undo_stack();
    const int expected = std::min(stack.index() + 1, stack.count());
    focus_a_pane();
    input_.key(chance(0.5) ? "ctrl+y" : "ctrl+shift+z");
    wait_until([&] { return stack.index() == expected; }, kLateMs);
  }
  void nudge() {
    effect_ = Effect::edit;
    focus_a_pane();
    const QString arrow = one_of(std::array<const char*, 4>{"Left", "Right", "Up", "Down"});
    input_.key(QString(chance(0.5) ? "ctrl+" : "alt+") + (chance(0.3) ? "shift+" : "") + arrow);
  }
  void drag_end() {
    effect_ = Effect::edit;
    const DrillPath* path = planner().document().chosen_path();
    if (path == nullptr) return;
    SliceView& pane = random_slice();
    if (!pane.isVisible() || !planner().document().opened()) return;
    const QPoint from = pane.place_of(chance(0.5) ? path->entry_mm : path->target_mm).toPoint();
    if (!pane.rect().contains(from)) return;
    input_.move(pane, from);
    input_.press();
    input_.move(pane, from + QPoint(below(41) - 20, below(41) - 20));
    if (chance(0.15)) input_.key("Escape");
    if (chance(0.1)) input_.key("ctrl+e");
    input_.release();
  }
  void mouse() {
    effect_ = Effect::edit;  // it may meet a handle
    QWidget* pane = window_->panes().pane(one_of(std::array<const char*, 4>{"axial", "coronal", "sagittal", "3d"}));
    if (!pane->isVisible()) return;
    const auto button = static_cast<MouseButton>(1 + below(3));
    if (chance(0.3)) return input_.click(*pane, random_place(*pane), button);
    if (chance(0.2)) return input_.double_click(*pane, random_place(*pane));
    input_.drag(*pane, random_place(*pane), random_place(*pane), button);
  }
  void wheel() {
    QWidget* pane = window_->panes().pane(one_of(std::array<const char*, 4>{"axial", "coronal", "sagittal", "3d"}));
    if (!pane->isVisible()) return;
    input_.move(*pane, random_place(*pane));
    const int steps = below(7) - 3;
    chance(0.2) ? input_.hold("ctrl", [&] { input_.wheel(steps); }) : input_.wheel(steps);
  }
  void key() {
    static const std::array<const char*, 41> keys{
        "F1",     "F2",     "F3",     "F4",     "F5",     "F12",     "F11",       "F6",      "F7",    "F8",    "F9",
        "ctrl+1", "ctrl+2", "ctrl+3", "ctrl+4", "ctrl+t", "ctrl+h",  "ctrl+e",    "alt+p",   "alt+a", "alt+r", "1",
        "2",      "3",      "4",      "5",      "6",      "7",       "r",         "plus",    "minus", "0",     "Tab",
        "Up",     "Down",   "Escape", "alt+f",  "alt+v",  "Page_Up", "Page_Down", "shift+F9"};
    focus_a_pane();  // letters and digits are names where the list has the keyboard
    const QString one = one_of(keys);
    note(one.toStdString());
    input_.key(one);
  }
  void add() {
    effect_ = Effect::edit;
    focus_a_pane();
    if (chance(0.5) && planner().document().opened()) {
      SliceView& pane = random_slice();
      if (pane.isVisible()) input_.click(pane, pane.rect().center() + QPoint(below(81) - 40, below(81) - 40));
    }
    input_.key("ctrl+n");
  }
  void remove() {
    effect_ = Effect::edit;
    focus_a_pane();
    input_.key("Delete");
  }
  template <class Widget>
  Widget& child(const char* name) {
    auto* found = window_->findChild<Widget*>(name);
    if (found == nullptr) fail("the window has no ", name);
    return *found;
  }
  void number() {
    effect_ = Effect::edit;
    window_->show_page("plan");
    auto& box = child<QDoubleSpinBox>(one_of(std::array<const char*, 8>{
        "entryL", "entryP", "entryS", "targetL", "targetP", "targetS", "bitDiameter", "bitLength"}));
    if (!box.isEnabled()) return;
    focus(box);
    if (chance(0.3)) return input_.key(chance(0.5) ? "Up" : "Down");
    input_.key("ctrl+a");
    input_.type(one_of(std::array<const char*, 7>{"3", "-12.345", "40", "0", "99999", "1e9", "abc"}));
    input_.key(chance(0.8) ? "Return" : "Tab");
  }
  void rename() {
    effect_ = Effect::edit;
    window_->show_page("plan");
    auto& list = child<QTableWidget>("paths");
    if (list.rowCount() == 0) return;
    focus(list);
    input_.type(one_of(std::array<const char*, 5>{"left", "right", "a b", "x", "path"}));
    input_.key(chance(0.8) ? "Return" : "Escape");
  }
  void tool() {
    effect_ = Effect::edit;
    window_->show_page("plan");
    auto& box = child<QComboBox>(chance(0.5) ? "screw" : "bit");
    if (!box.isEnabled()) return;
    focus(box);
    input_.key(chance(0.5) ? "Up" : "Down");
  }
  void suggest() {
    focus_a_pane();
    input_.key("ctrl+g");
    if (chance(0.5)) wait_until([&] { return !planner().job().is_running(); }, 60000);
  }
  void save() {
    const bool was_dirty = planner().has_unsaved_changes();
    focus_a_pane();
    input_.key(chance(0.5) ? "ctrl+s" : "ctrl+shift+s");
    settle();
    const fs::path file = planner().plan_file();
    if (planner().has_unsaved_changes() || file.empty() || !was_dirty) return;
    if (const std::string wrong = model_->check_file(file); !wrong.empty()) trouble(wrong);
    ++saved_;
  }
  void open() {
    effect_ = Effect::replaces;
    focus_a_pane();
    const char* name = one_of(std::array<const char*, 9>{"bone.vdb", "plan.json", "other.mrk.json", "broken.json",
                                                         "broken.vdb", "none.vdb", "ct", "spine", "none"});
    note(name);
    next_file_ = text_of((folder_.path() / name).string());
    input_.key(fs::is_directory(folder_.path() / name) ? "ctrl+shift+o" : "ctrl+o");
    settle();
    next_file_.clear();
    if (chance(0.3)) wait_until([&] { return !planner().is_working(); }, 120000);
  }
  /// On the page of the CT: a vertebra, all of them, or the one at the crosshair.
  void level() {
    effect_ = Effect::replaces;
    window_->show_page("ct");
    let_work(10);
    auto& list = child<QTableWidget>("levels");
    if (chance(0.2)) return input_.key("ctrl+b");
    if (chance(0.2)) return input_.key("ctrl+l");
    for (const char* name : {"bakeAll", "findLevels"}) {
      if (auto& button = child<QPushButton>(name); button.isVisible() && chance(0.3)) return input_.click(button);
    }
    if (list.rowCount() == 0) return;
    const QRect row = list.visualItemRect(list.item(below(list.rowCount()), 0));
    if (list.viewport()->rect().contains(row.center())) input_.click(*list.viewport(), row.center());
    settle();
    if (chance(0.3)) wait_until([&] { return !planner().is_working(); }, 120000);
  }
  void drill() {
    focus_a_pane();
    switch (below(5)) {
      case 0:
        child<QComboBox>("drill_speed").setCurrentIndex(below(6));
        [[fallthrough]];
      case 1:
        input_.key("F6");
        return let_work(below(1500));
      case 2:
        return input_.key("F7");
      case 3:
        return input_.key(one_of(std::array<const char*, 3>{"F8", "F9", "shift+F9"}));
      default:
        next_file_ = text_of((folder_.path() / "record.h5").string());
        input_.key("ctrl+alt+s");
        settle();
        next_file_.clear();
    }
  }
  void cancel() {
    auto& button = child<QToolButton>(chance(0.5) ? "cancel" : "levelsCancel");
    if (button.isVisible()) input_.click(button);
  }
  void resize() { window_->resize(1024 + below(377), 700 + below(201)); }
  void close_window() {
    note("close");
    if (window_->isFullScreen()) window_->setWindowState(Qt::WindowNoState);
    window_->close();
    settle();
    wait_until([&] { return !planner().is_working(); }, 120000);
    settle();
    if (window_->isVisible()) return;
    if (const std::string wrong = model_->check_closed(); !wrong.empty()) trouble(wrong);
    window_.reset();
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(work_folder(), none)) {
      trouble("after a clean end there is " + entry.path().filename().string());
    }
    open_window();
  }
  void stop_all() {
    planner().cancel();
    planner().levels().cancel();
    planner().player().stop();
    wait_until([&] { return !planner().is_working(); }, 60000);
    model_.reset();
    window_.reset();
  }

  TesterOptions options_;
  std::mt19937 random_;
  TemporaryFolder folder_;
  XInput input_;
  HangWatch hangs_;
  std::optional<DeadlockGuard> deadlock_;
  QTimer answers_;
  std::unique_ptr<MainWindow> window_;
  std::optional<PlanModel> model_;
  Effect effect_ = Effect::none;
  QString next_file_;
  const QWidget* answered_ = nullptr;
  std::vector<const QWidget*> answering_;
  std::mutex mutex_;
  std::deque<std::string> last_;
  std::map<std::string, int> counts_;
  int actions_ = 0, troubles_ = 0, saved_ = 0, windows_ = 0;
  double longest_s_ = 0.0;
};

TesterOptions options_of(int argc, char** argv) {
  TesterOptions options;
  for (int n = 1; n + 1 < argc; n += 2) {
    const std::string name = argv[n], value = argv[n + 1];
    if (name == "--seconds") {
      options.seconds = std::stod(value);
    } else if (name == "--seed") {
      options.seed = static_cast<unsigned>(std::stoul(value));
    } else if (name == "--max-hang") {
      options.max_hang_s = std::stod(value);
    } else {
      fail("expected --seconds N, --seed N or --max-hang S, found ", name);
    }
  }
  return options;
}

int run_tester(int argc, char** argv) {
  const TesterOptions options = options_of(argc, argv);
  const TemporaryFolder home;
  for (const char* name : {"XDG_STATE_HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME"}) {
    ::setenv(name, (home.path() / name).c_str(), 1);
  }
  const QApplication application(argc, argv);
  QApplication::setOrganizationName("SpinalTap");
  QApplication::setApplicationName("random-tester");
  return RandomTester(options).run() == 0 ? 0 : 1;
}

}  // namespace
}  // namespace spinaltap::test

int main(int argc, char** argv) {
  spinaltap::allow_process_changes({.silences_decoders = true, .silences_hdf5_at_exit = true});
  try {
    return spinaltap::test::run_tester(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "random_tester: %s\n", error.what());
  }
  return 2;
}
