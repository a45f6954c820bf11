#pragma once

#include <QObject>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/tool/drill_path.h"

namespace spinaltap {
class MainWindow;
}

namespace spinaltap::test {

/// What an action may do to the plan.
enum class Effect {
  none,     ///< nothing: it looks, drills or saves
  edit,     ///< any change, one step back each
  undo,     ///< to the plan before, where there is one
  redo,     ///< to the plan after
  replaces  ///< another plan or bone, in place of what was saved or given up
};

/// The history of the plan as a person would tell it: each plan that was seen, in a row, and which of them is now. Says
/// where the window does not agree.
class PlanModel {
 public:
  explicit PlanModel(MainWindow& window);

  ~PlanModel() {
    QObject::disconnect(follows_);
    QObject::disconnect(follows_saves_);
  }
  PlanModel(const PlanModel&) = delete;
  PlanModel& operator=(const PlanModel&) = delete;

  /// What was opened is another plan.
  void begin();
  /// The person was asked, and gave up what was not saved.
  void give_up() { is_given_up_ = true; }
  /// The window has closed. Empty: what was not saved was given up.
  std::string check_closed() const;
  /// After an action, when the window has settled. Empty: all agrees.
  std::string check(Effect effect);
  /// The list, the numbers, the title and the menu show the plan. Empty: they do.
  std::string check_window() const;
  /// What is kept for after a crash in a folder is the plan, where that is not saved.
  std::string check_kept(const std::filesystem::path& folder) const;
  /// A file that was saved holds the plan.
  std::string check_file(const std::filesystem::path& file) const;

 private:
  /// The plan as it stands, or stood after one change.
  struct Seen {
    std::vector<DrillPath> paths;
    int index = 0, count = 0;  ///< of the undo stack
    bool is_suggested = false;
  };
  Seen seen_now() const;
  std::string follow(Effect effect, const Seen& stack);
  /// What the file that it was saved to last holds, for people.
  std::string words_of_saved() const;
  /// The file that it was saved to last has these paths.
  bool is_saved(const std::vector<DrillPath>& paths) const;

  MainWindow& window_;
  std::vector<std::optional<std::vector<DrillPath>>> plans_;  ///< nothing: not seen, between two changes at once
  int now_ = 0;
  std::vector<Seen> seen_;         ///< after each change since the last check
  std::vector<DrillPath> latest_;  ///< as it stood last before it was replaced: suggestions come while a box is asked
  QMetaObject::Connection follows_, follows_saves_;
  const void* bone_ = nullptr;
  bool was_clean_ = true;
  bool is_given_up_ = false;
  std::filesystem::path saved_in_;  ///< the plan's file when it was last the plan; empty: since it is open, never
};

bool are_same(const std::vector<DrillPath>& a, const std::vector<DrillPath>& b);

}  // namespace spinaltap::test
