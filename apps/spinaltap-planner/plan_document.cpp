#include "apps/spinaltap-planner/plan_document.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"

namespace spinaltap {

/// A change of the plan, as the paths before and after it: plans are short.
class ReplacePaths final : public QUndoCommand {
 public:
  ReplacePaths(PlanDocument& document, std::vector<DrillPath> paths, int chosen, const QString& what,
               std::uint64_t drag)
      : QUndoCommand(what),
        document_(document),
        before_(document.paths_),
        after_(std::move(paths)),
        chosen_before_(document.chosen_),
        chosen_after_(chosen),
        drag_(drag) {}
  ReplacePaths(const ReplacePaths& other)
      : QUndoCommand(other.text()),
        document_(other.document_),
        before_(other.before_),
        after_(other.after_),
        chosen_before_(other.chosen_before_),
        chosen_after_(other.chosen_after_),
        drag_(other.drag_) {}

  std::uint64_t drag() const { return drag_; }

  /// The next undo() also removes it from the stack.
  void give_up() { is_given_up_ = true; }

  void undo() override {
    document_.take_paths(before_, chosen_before_);
    setObsolete(is_given_up_);
  }
  void redo() override { document_.take_paths(after_, chosen_after_); }
  int id() const override { return drag_ == 0 ? -1 : 1; }
  bool mergeWith(const QUndoCommand* other) override {
    const auto* next = dynamic_cast<const ReplacePaths*>(other);
    if (next == nullptr || next->drag_ != drag_) return false;
    after_ = next->after_;
    return true;
  }

 private:
  PlanDocument& document_;
  std::vector<DrillPath> before_, after_;
  int chosen_before_, chosen_after_;
  std::uint64_t drag_;
  bool is_given_up_ = false;
};

/// The stack as it was before a drag, which takes what could be redone from it.
struct PlanDocument::Drag {
  ReplacePaths* step = nullptr;  ///< of the drag; the stack's
  std::vector<std::unique_ptr<ReplacePaths>> redo;
  int clean_index = -1;
};

namespace {

std::string unlike(const std::vector<DrillPath>& paths, const std::string& name) {
  std::string stem = name.empty() ? "path" : name;
  const auto is_taken = [&](const std::string& tried) {
    return std::any_of(paths.begin(), paths.end(), [&](const DrillPath& path) { return path.name == tried; });
  };
  if (!is_taken(stem)) return stem;
  int n = 2;
  while (is_taken(stem + " " + std::to_string(n))) ++n;
  return stem + " " + std::to_string(n);
}

}  // namespace

PlanDocument::PlanDocument(QObject* parent) : QObject(parent) {}

PlanDocument::~PlanDocument() = default;

void PlanDocument::set_bone(std::shared_ptr<const OpenedBone> bone) {
  if (!opened_ || !bone || opened_->volume != bone->volume) set_levels(nullptr);
  opened_ = std::move(bone);
  bone_ = opened_ && opened_->bone ? opened_ : nullptr;
  Q_EMIT bone_changed();
  set_paths({});
}

void PlanDocument::set_levels(std::shared_ptr<const SpineSegmentation> levels) {
  if (levels == levels_) return;
  levels_ = std::move(levels);
  Q_EMIT levels_changed();
}

void PlanDocument::set_paths(std::vector<DrillPath> paths) {
  for (const DrillPath& path : paths) check_path(path);
  undo_stack_.clear();
  drag_.reset();
  const int chosen = paths.empty() ? -1 : 0;
  take_paths(std::move(paths), chosen);
}

const DrillPath* PlanDocument::chosen_path() const {
  return chosen_ < 0 ? nullptr : &paths_[static_cast<std::size_t>(chosen_)];
}

void PlanDocument::choose(int index) {
  if (index < -1 || index >= static_cast<int>(paths_.size())) fail("expected a path from 0 to ", paths_.size(), " - 1");
  if (index == chosen_) return;
  chosen_ = index;
  Q_EMIT chosen_changed();
}

int PlanDocument::add_path(DrillPath path) {
  add_paths({std::move(path)}, tr("add path"));
  return chosen_;
}

void PlanDocument::add_paths(std::vector<DrillPath> added, const QString& what) {
  if (added.empty()) return;
  std::vector<DrillPath> paths = paths_;
  for (DrillPath& path : added) {
    check_path(path);
    path.name = unlike(paths, path.name);
    paths.push_back(std::move(path));
  }
  push(new ReplacePaths(*this, std::move(paths), static_cast<int>(paths_.size()), what, 0));
}

void PlanDocument::remove_path(int index) {
  std::vector<DrillPath> paths = paths_;
  if (index < 0 || index >= static_cast<int>(paths.size())) fail("expected a path to remove, found none");
  paths.erase(paths.begin() + index);
  const int chosen = std::min(chosen_, static_cast<int>(paths.size()) - 1);
  push(new ReplacePaths(*this, std::move(paths), chosen, tr("remove path"), 0));
}

void PlanDocument::change_path(int index, DrillPath path, const QString& what, std::uint64_t drag) {
  check_path(path);
  std::vector<DrillPath> paths = paths_;
  DrillPath& changed = paths.at(static_cast<std::size_t>(index));
  if (path.name != changed.name) path.name = unlike(paths, path.name);
  changed = std::move(path);
  push(new ReplacePaths(*this, std::move(paths), chosen_, what, drag));
}

bool PlanDocument::move_end(int index, PathEnd end, const Vec3& p_mm, std::uint64_t drag) {
  if (!p_mm.allFinite()) return false;
  DrillPath path = paths_.at(static_cast<std::size_t>(index));
  if (end == PathEnd::entry) {
    path.entry_mm = bone_ ? stick_to_surface(*bone_, p_mm) : p_mm;
  } else {
    path.target_mm = p_mm;
  }
  try {
    change_path(index, path, end == PathEnd::entry ? tr("move entry") : tr("move target"), drag);
  } catch (const Error&) {
    return false;
  }
  return true;
}

void PlanDocument::push(ReplacePaths* change) {
  const int index = undo_stack_.index(), count = undo_stack_.count();
  const bool goes_on = drag_ && index == count && index > 0 && undo_stack_.command(index - 1) == drag_->step &&
                       drag_->step->drag() == change->drag();
  if (change->drag() != 0 && !goes_on) {
    drag_ = std::make_unique<Drag>();
    drag_->step = change;
    drag_->clean_index = undo_stack_.cleanIndex();
    for (int step = index; step < count; ++step) {
      drag_->redo.push_back(
          std::make_unique<ReplacePaths>(dynamic_cast<const ReplacePaths&>(*undo_stack_.command(step))));
    }
  }
  undo_stack_.push(change);
}

void PlanDocument::give_up(std::uint64_t drag) {
  const int index = undo_stack_.index();
  const bool is_last = drag_ && index > 0 && index == undo_stack_.count() &&
                       undo_stack_.command(index - 1) == drag_->step && drag_->step->drag() == drag;
  if (!is_last) return;
  const std::unique_ptr<Drag> given_up = std::move(drag_);
  given_up->step->give_up();
  undo_stack_.undo();
  keeps_paths_ = true;
  for (std::unique_ptr<ReplacePaths>& step : given_up->redo) {
    undo_stack_.push(step.release());
    if (undo_stack_.index() == given_up->clean_index) undo_stack_.setClean();
  }
  undo_stack_.setIndex(index - 1);
  keeps_paths_ = false;
}

void PlanDocument::take_paths(std::vector<DrillPath> paths, int chosen) {
  if (keeps_paths_) return;
  paths_ = std::move(paths);
  ++revision_;
  const bool is_other = chosen != chosen_;
  chosen_ = std::min(chosen, static_cast<int>(paths_.size()) - 1);
  Q_EMIT paths_changed();
  if (is_other) Q_EMIT chosen_changed();
}

}  // namespace spinaltap
