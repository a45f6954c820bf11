#include "tests/gui/random_tester/plan_model.h"

#include <QAction>
#include <QDoubleSpinBox>
#include <QTableWidget>
#include <QUndoStack>
#include <cmath>
#include <sstream>

#include "apps/spinaltap-planner/window/main_window.h"
#include "apps/spinaltap-planner/window/words.h"
#include "core/base/error.h"
#include "core/files/plan_file.h"

namespace spinaltap::test {
namespace {

std::string words_of_plan(const std::vector<DrillPath>& paths) {
  std::ostringstream text;
  text << paths.size() << " paths:";
  for (const DrillPath& path : paths) {
    text << " \"" << path.name << "\" " << path.entry_mm.transpose() << " to " << path.target_mm.transpose() << ", bit "
         << path.bit.diameter_mm << " x " << path.bit.length_mm << (path.screw ? ", " + path.screw->name : "") << ";";
  }
  return text.str();
}

template <class Widget>
Widget& part(const MainWindow& window, const char* name) {
  auto* found = window.findChild<Widget*>(name);
  if (found == nullptr) throw Error(std::string("the window has no ") + name);
  return *found;
}

}  // namespace

bool are_same(const std::vector<DrillPath>& a, const std::vector<DrillPath>& b) {
  return plan_text(a) == plan_text(b);  // every key, every digit
}

PlanModel::PlanModel(MainWindow& window) : window_(window) {
  const QUndoStack& stack = window_.planner().document().undo_stack();
  follows_ = QObject::connect(&stack, &QUndoStack::indexChanged, [this, &stack] {
    if (stack.count() == 0) return;  // it is being replaced
    seen_.push_back(seen_now());
    latest_ = seen_.back().paths;
  });
  follows_saves_ = QObject::connect(&stack, &QUndoStack::cleanChanged, [this, &stack](bool is_clean) {
    if (is_clean && stack.count() > 0) saved_in_ = window_.planner().plan_file();
  });
  begin();
}

void PlanModel::begin() {
  const PlanDocument& document = window_.planner().document();
  plans_.assign(static_cast<std::size_t>(document.undo_stack().count()) + 1, std::nullopt);
  now_ = document.undo_stack().index();
  plans_[static_cast<std::size_t>(now_)] = document.paths();
  latest_ = document.paths();
  seen_.clear();
  bone_ = document.opened().get();
  was_clean_ = !window_.planner().has_unsaved_changes();
  is_given_up_ = false;
  saved_in_.clear();
}

std::string PlanModel::check(Effect effect) {
  // Suggestions come when they are ready, also after the key that takes a step back.
  std::string trouble;
  const bool takes_steps = effect == Effect::undo || effect == Effect::redo;
  if (takes_steps && seen_.size() > 1 && seen_.back().is_suggested) {
    trouble = follow(effect, seen_[seen_.size() - 2]);
    effect = Effect::none;
  }
  if (trouble.empty()) trouble = follow(effect, seen_now());
  seen_.clear();
  was_clean_ = !window_.planner().has_unsaved_changes();
  const Planner& planner = window_.planner();
  if (was_clean_ || !(planner.job().is_running() || planner.is_to_open())) is_given_up_ = false;
  return trouble.empty() ? check_window() : trouble;
}

std::string PlanModel::check_closed() const {
  return window_.planner().has_unsaved_changes() && !is_given_up_ ? "closed without a question, with changes not saved"
                                                                  : "";
}

bool PlanModel::is_saved(const std::vector<DrillPath>& paths) const {
  try {
    return !saved_in_.empty() && are_same(read_plan(saved_in_), paths);
  } catch (const Error&) {
    return false;
  }
}

std::string PlanModel::words_of_saved() const {
  if (saved_in_.empty()) return "nowhere";
  try {
    return saved_in_.string() + ", " + words_of_plan(read_plan(saved_in_));
  } catch (const Error& error) {
    return error.what();
  }
}

PlanModel::Seen PlanModel::seen_now() const {
  const PlanDocument& document = window_.planner().document();
  const QUndoStack& stack = document.undo_stack();
  return {document.paths(), stack.index(), stack.count(), stack.undoText() == "suggest paths"};
}

std::string PlanModel::follow(Effect effect, const Seen& stack) {
  const PlanDocument& document = window_.planner().document();
  const std::vector<DrillPath>& paths = stack.paths;
  const std::vector<DrillPath> before = plans_[static_cast<std::size_t>(now_)].value_or(paths);
  const auto differs = [&](const std::string& expected) {
    std::string steps;
    for (const Seen& one : seen_) steps += " " + std::to_string(one.index);
    return "expected " + expected + ", found " + words_of_plan(paths) + " after " + words_of_plan(before) +
           " at step " + std::to_string(now_) + ", then" + steps + ", of " + std::to_string(stack.count);
  };
  const bool is_replaced = document.opened().get() != bone_ || (stack.count == 0 && plans_.size() > 1) ||
                           (stack.count == 0 && effect == Effect::replaces && !are_same(paths, before));
  if (is_replaced) {
    if (!was_clean_ && !is_given_up_ && !is_saved(latest_)) {
      return differs("a question before the plan is replaced") + "; last " + words_of_plan(latest_) +
             "; saved: " + words_of_saved();
    }
    begin();
    return {};
  }
  int expected = now_;
  if (effect == Effect::undo) expected = std::max(now_ - 1, 0);
  if (effect == Effect::redo) expected = std::min(now_ + 1, static_cast<int>(plans_.size()) - 1);
  auto& seen = plans_[static_cast<std::size_t>(expected)];
  if (stack.index == expected && (!seen || are_same(paths, *seen))) {
    seen = paths;
    now_ = expected;
    // Also after a drag that was given up.
    if (stack.count + 1 != static_cast<int>(plans_.size())) return differs("what could be redone to be there still");
    return {};
  }
  // Whatever is done meanwhile.
  const bool is_suggested = stack.index == now_ + 1 && stack.is_suggested;
  if (effect != Effect::edit && !is_suggested) {
    return differs(effect == Effect::none   ? "the plan as it was"
                   : effect == Effect::undo ? "the plan before"
                                            : "the plan after");
  }
  if (stack.index <= now_) return differs("a change with a step back of its own");
  plans_.resize(static_cast<std::size_t>(now_) + 1);
  // Several at once were made by several keys of one action; what lay between was not seen.
  plans_.resize(static_cast<std::size_t>(stack.index));
  plans_.emplace_back(paths);
  now_ = stack.index;
  if (stack.count != now_) return differs("nothing to redo after a change");
  return {};
}

std::string PlanModel::check_window() const {
  Planner& planner = window_.planner();
  const PlanDocument& document = planner.document();
  const std::vector<DrillPath>& paths = document.paths();
  const auto& list = part<QTableWidget>(window_, "paths");
  std::ostringstream trouble;
  if (list.rowCount() != static_cast<int>(paths.size())) {
    trouble << "expected " << paths.size() << " rows in the list of paths, found " << list.rowCount() << "; ";
  } else {
    for (int row = 0; row < list.rowCount(); ++row) {
      const std::string shown = list.item(row, 0)->text().toStdString();
      if (shown != paths[static_cast<std::size_t>(row)].name) {
        trouble << "expected the name " << paths[static_cast<std::size_t>(row)].name << ", found " << shown << "; ";
      }
    }
    if (list.currentRow() != document.chosen()) {
      trouble << "expected row " << document.chosen() << " to be chosen, found " << list.currentRow() << "; ";
    }
  }
  if (const DrillPath* chosen = document.chosen_path()) {
    constexpr double kShownMm = 0.00501;  // two decimals
    const char* const names[2][3] = {{"entryL", "entryP", "entryS"}, {"targetL", "targetP", "targetS"}};
    for (int end = 0; end < 2; ++end) {
      const Vec3& place = end == 0 ? chosen->entry_mm : chosen->target_mm;
      for (int axis = 0; axis < 3; ++axis) {
        const double shown = part<QDoubleSpinBox>(window_, names[end][axis]).value();
        if (std::abs(shown - place[axis]) <= kShownMm) continue;
        trouble << "expected " << names[end][axis] << " to show " << place[axis] << ", found " << shown << "; ";
      }
    }
  }
  if (window_.isWindowModified() != planner.has_unsaved_changes()) {
    trouble << "the title does not say whether the plan is saved; ";
  }
  if (document.undo_stack().canUndo() != (now_ > 0)) trouble << "undo is not offered as it should be; ";
  return trouble.str();
}

std::string PlanModel::check_kept(const std::filesystem::path& folder) const {
  Planner& planner = window_.planner();
  const std::vector<DrillPath>& paths = planner.document().paths();
  if (!planner.has_unsaved_changes() || paths.empty() || !planner.document().bone()) return {};
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    if (entry.path().extension() == ".json" && are_same(read_plan(entry.path()), paths)) return {};
  }
  return "what is kept for after a crash is not the plan: " + words_of_plan(paths);
}

std::string PlanModel::check_file(const std::filesystem::path& file) const {
  const std::vector<DrillPath> read = read_plan(file);
  const PlanDocument& document = window_.planner().document();
  std::vector<DrillPath> paths = document.paths();
  for (DrillPath& path : paths) {  // files name it
    if (path.bone.is_empty() && document.bone()) path.bone = document.bone()->bone->identity();
  }
  if (are_same(read, paths)) return {};
  return "saved " + words_of_plan(paths) + ", read back " + words_of_plan(read);
}

}  // namespace spinaltap::test
